#include "tools/task/task_draft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <set>
#include <stdexcept>

#include "common/assembly/task_file.h"
#include "common/configuration/yaml_reader.h"
#include "common/geometry/mesh_tree.h"
#include "tools/operator/outline.h"
#include "tools/task/congruence.h"

namespace coach {
namespace {

namespace fs = std::filesystem;

constexpr int kContactPoints = 3000;
constexpr int kLeastContact = 8;    // points that must touch
constexpr double kOverlap = 0.002;  // m, deeper is worth a word
constexpr double kSmallest = 0.02;  // m, of a part that the camera can tell
constexpr double kLargest = 0.5;    // m
constexpr size_t kMostSymmetryVertices = 3000;

/// A name as task files want it.
std::string Tidy(const std::string& text, const std::string& otherwise) {
  std::string name;
  for (const char c : text) {
    const bool good =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    name += good ? c : '_';
  }
  name = name.substr(0, 48);
  return name.find_first_not_of("_-") == std::string::npos ? otherwise : name;
}

/// "brick.001", "brick_2" -> "brick"
std::string WithoutNumber(std::string name) {
  while (!name.empty() && (std::isdigit(static_cast<unsigned char>(name.back())) || name.back() == '_' ||
                           name.back() == '.' || name.back() == ' '))
    name.pop_back();
  return name;
}

template <class Items>
std::string Unused(const std::string& name, const Items& taken) {
  std::string free = name;
  for (int k = 2; taken.count(free) > 0; ++k) free = name + "_" + std::to_string(k);
  return free;
}

std::string Numbers(const double* values, int n) {
  std::string text = "[";
  for (int k = 0; k < n; ++k) {
    char number[32];
    std::snprintf(number, sizeof number, "%s%.7g", k ? ", " : "", std::abs(values[k]) < 5e-8 ? 0 : values[k]);
    text += number;
  }
  return text + "]";
}

std::string RotationText(const Matrix3& R) {
  const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = R;
  return Numbers(rows.data(), 9);
}

std::string SymmetriesText(const SymmetryGroup& group) {
  if (group.trivial()) return "";
  std::string text = "    symmetries:\n      discrete: [";
  for (size_t k = 1; k < group.discrete.size(); ++k) text += (k > 1 ? ", " : "") + RotationText(group.discrete[k]);
  text += "]\n      continuous: [";
  for (size_t k = 0; k < group.axes.size(); ++k) text += (k ? ", " : "") + Numbers(group.axes[k].data(), 3);
  return text + "]\n";
}

/// Points of one part on or in another: how many touch, and how deep the deepest is inside (m).
struct Touch {
  int points = 0;
  double depth = 0;
};
Touch TouchOf(const std::vector<SurfacePoint>& samples, const Pose& X_BA, const MeshTree& b, const MeshExtent& box,
              double tolerance) {
  Touch touch;
  for (const auto& sample : samples) {
    const Vector3 p = X_BA * sample.p;
    if (((p - box.high).array() > tolerance).any() || ((box.low - p).array() > tolerance).any()) continue;
    const double distance = b.SignedDistance(p);
    touch.points += distance <= tolerance;
    touch.depth = std::max(touch.depth, -distance);
  }
  return touch;
}

/// Calls f(i, j, touch) for every pair of placed parts.
void ForEachPair(const TaskDraft& draft, double tolerance, const std::function<void(int, int, const Touch&)>& f) {
  std::vector<MeshTree> trees;
  std::vector<std::vector<SurfacePoint>> samples;
  std::vector<MeshExtent> boxes;
  for (const auto& type : draft.types) {
    trees.emplace_back(type.mesh);
    samples.push_back(SampleSurface(type.mesh, kContactPoints));
    boxes.push_back(Extent(type.mesh));
  }
  for (int i = 0; i < static_cast<int>(draft.parts.size()); ++i) {
    for (int j = i + 1; j < static_cast<int>(draft.parts.size()); ++j) {
      const PlacedPart &a = draft.parts[static_cast<size_t>(i)], &b = draft.parts[static_cast<size_t>(j)];
      const auto ta = static_cast<size_t>(a.type), tb = static_cast<size_t>(b.type);
      const Pose X_AB = a.X_FP.inverse() * b.X_FP;
      const double reach =
          (boxes[ta].diameter + boxes[tb].diameter) / 2 + boxes[ta].centre.norm() + boxes[tb].centre.norm();
      if (X_AB.translation().norm() > reach + tolerance) continue;
      const Touch one = TouchOf(samples[tb], X_AB, trees[ta], boxes[ta], tolerance),
                  other = TouchOf(samples[ta], X_AB.inverse(), trees[tb], boxes[tb], tolerance);
      f(i, j, {std::max(one.points, other.points), std::max(one.depth, other.depth)});
    }
  }
}

/// Vertices of the draft's types are about their middle.
TriangleMesh Centred(TriangleMesh mesh, const Vector3& middle) {
  for (auto& v : mesh.vertices) v -= middle;
  return mesh;
}

void WriteText(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.flush();
  if (!out) throw std::runtime_error(file.string() + ": can't be written");
}

}  // namespace

const std::map<std::string, HsvRange>& ColourWords() {
  static const std::map<std::string, HsvRange> words{
      {"blue", {{100, 110, 40}, {126, 255, 255}}}, {"green", {{42, 80, 30}, {84, 255, 255}}},
      {"red", {{172, 110, 50}, {8, 255, 255}}},    {"yellow", {{22, 110, 90}, {34, 255, 255}}},
      {"orange", {{9, 130, 90}, {20, 255, 255}}},  {"purple", {{128, 70, 40}, {155, 255, 255}}},
      {"pink", {{156, 60, 120}, {171, 255, 255}}}, {"brown", {{6, 80, 30}, {20, 220, 140}}},
      {"white", {{0, 0, 170}, {179, 50, 255}}},    {"black", {{0, 0, 0}, {179, 120, 55}}}};
  return words;
}

DraftType MakeType(const std::string& name, const std::string& colour, const TriangleMesh& mesh,
                   const DraftOptions& options) {
  DraftType type;
  type.name = Tidy(name, "part");
  type.colour = colour;
  if (const auto known = ColourWords().find(colour); known != ColourWords().end()) type.hsv = known->second;
  const TriangleMesh simple = Simplified(mesh, options.most_triangles);
  type.mesh = Centred(simple, MiddleOf(simple));
  if (type.mesh.vertices.size() <= kMostSymmetryVertices) type.symmetries = SymmetriesOf(type.mesh);
  return type;
}

TaskDraft DraftOfModel(const std::string& name, const std::vector<MeshPiece>& pieces,
                       const std::vector<DraftType>& known, const DraftOptions& options) {
  TaskDraft draft;
  draft.name = name;
  draft.types = known;
  for (auto& type : draft.types) type.count = 0;
  std::set<std::string> names, slots;
  for (const auto& type : known) names.insert(type.name);
  for (const auto& piece : pieces) {
    PlacedPart part;
    const TriangleMesh mesh = Simplified(piece.mesh, options.most_triangles);
    std::vector<Pose> poses;
    for (part.type = 0; part.type < static_cast<int>(draft.types.size()); ++part.type) {
      poses = Alignments(draft.types[static_cast<size_t>(part.type)].mesh, mesh, {.most = 1});
      if (!poses.empty()) break;
    }
    if (poses.empty()) {
      if (!known.empty()) throw std::runtime_error("'" + piece.name + "' of the finished model is none of the parts");
      static constexpr std::array kTurn{"blue", "green", "red", "yellow", "orange", "purple"};
      const std::string colour = kTurn[draft.types.size() % kTurn.size()];
      const std::string type_name = Unused(Tidy(WithoutNumber(piece.name), "part"), names);
      draft.types.push_back(MakeType(type_name, colour, mesh, options));
      draft.types.back().count = 0;
      names.insert(type_name);
      poses.push_back(MakePose(Matrix3::Identity(), MiddleOf(mesh)));
    }
    auto& type = draft.types[static_cast<size_t>(part.type)];
    part.X_FP = poses[0];
    part.slot = Unused(type.name + "_" + std::string(1, static_cast<char>('a' + type.count % 26)), slots);
    slots.insert(part.slot);
    ++type.count;
    draft.parts.push_back(part);
  }
  std::erase_if(draft.types, [](const DraftType& type) { return type.count == 0; });
  if (draft.types.size() < known.size()) return DraftOfModel(name, pieces, draft.types, options);
  return draft;
}

Contacts FindContacts(const TaskDraft& draft, const DraftOptions& options) {
  const size_t n = draft.parts.size();
  std::vector<std::vector<int>> touching(n);
  ForEachPair(draft, options.touching, [&](int i, int j, const Touch& touch) {
    if (touch.points < kLeastContact) return;
    touching[static_cast<size_t>(i)].push_back(j);
    touching[static_cast<size_t>(j)].push_back(i);
  });
  Contacts contacts;
  std::vector<bool> seen(n, false);
  std::set<std::pair<int, int>> listed;
  const std::function<void(int)> visit = [&](int i) {
    seen[static_cast<size_t>(i)] = true;
    for (const int j : touching[static_cast<size_t>(i)]) {
      if (!listed.insert(std::minmax(i, j)).second) continue;
      const bool closes = seen[static_cast<size_t>(j)];
      (closes ? contacts.closing : contacts.joining).emplace_back(i, j);
      if (!closes) visit(j);
    }
  };
  for (size_t i = 0; i < n; ++i) {
    if (!seen[i]) visit(static_cast<int>(i));
  }
  return contacts;
}

std::vector<Remark> Doubts(const TaskDraft& draft, const DraftOptions& options) {
  const auto millimetres = [](double metres) { return static_cast<int>(std::lround(metres * 1000)); };
  const double deep = std::max(kOverlap, options.touching);
  std::vector<Remark> doubts;
  for (const auto& type : draft.types) {
    const double size = Extent(type.mesh).diameter;
    if (size < kSmallest) doubts.push_back({"small", type.name, "", millimetres(size)});
    if (size > kLargest) doubts.push_back({"large", type.name, "", millimetres(size)});
    if (!ColourWords().contains(type.colour)) doubts.push_back({"colourless", type.name});
  }
  std::vector<bool> joined(draft.parts.size(), false);
  ForEachPair(draft, options.touching, [&](int i, int j, const Touch& touch) {
    const auto& [a, b] = std::pair(draft.parts[static_cast<size_t>(i)], draft.parts[static_cast<size_t>(j)]);
    if (touch.points >= kLeastContact) joined[static_cast<size_t>(i)] = joined[static_cast<size_t>(j)] = true;
    if (touch.depth > deep) doubts.push_back({"overlap", a.slot, b.slot, millimetres(touch.depth)});
  });
  for (size_t k = 0; draft.parts.size() > 1 && k < joined.size(); ++k) {
    if (!joined[k]) doubts.push_back({"alone", draft.parts[k].slot});
  }
  return doubts;
}

std::string TaskFileText(const TaskDraft& draft, const Contacts& contacts, const std::string& mesh_folder) {
  std::string text = "name: " + draft.name + "\nunits: mm\nparts:\n";
  int number = 0;
  for (const auto& type : draft.types) {
    const auto bound = [](const std::array<int, 3>& b) {
      return std::string("[") + std::to_string(b[0]) + ", " + std::to_string(b[1]) + ", " + std::to_string(b[2]) + "]";
    };
    text += "  - type: " + type.name + "\n    count: " + std::to_string(type.count) + "\n    mesh: " + mesh_folder +
            "/" + type.name + ".ply\n    mesh_units: mm\n    bop_id: " + std::to_string(++number) +
            "\n    colour: " + type.colour + "\n    hsv: {low: " + bound(type.hsv.low) +
            ", high: " + bound(type.hsv.high) + "}\n" + SymmetriesText(type.symmetries);
  }
  if (draft.parts.empty() || contacts.joining.empty()) return text;
  text += "slots:\n";
  for (const auto& part : draft.parts)
    text += "  - {name: " + part.slot + ", type: " + draft.types[static_cast<size_t>(part.type)].name + "}\n";
  text += "connections:\n";
  std::string steps;
  int connection = 0;
  const auto add = [&](const std::pair<int, int>& pair, bool closes) {
    const auto &a = draft.parts[static_cast<size_t>(pair.first)], &b = draft.parts[static_cast<size_t>(pair.second)];
    const Pose X_AB = a.X_FP.inverse() * b.X_FP;
    const Vector3 millimetres = X_AB.translation() * 1000;
    const std::string name = std::string("joint_") + std::to_string(++connection);
    text += "  - {name: " + name + ", slots: [" + a.slot + ", " + b.slot +
            "], rotation: " + RotationText(X_AB.linear()) + ", translation: " + Numbers(millimetres.data(), 3) +
            (closes ? ", closes_by_itself: true" : "") + "}\n";
    if (!closes) steps += (steps.empty() ? "" : ", ") + name;
  };
  for (const auto& pair : contacts.joining) add(pair, false);
  for (const auto& pair : contacts.closing) add(pair, true);
  return text + "steps: [" + steps + "]\n";
}

fs::path SaveTask(const TaskDraft& named, const fs::path& folder, bool replace, const DraftOptions& options) {
  TaskDraft draft = named;
  draft.name = Tidy(named.name, "task");
  const fs::path file = folder / (draft.name + ".yaml"), meshes = folder / draft.name;
  if (draft.types.empty()) throw std::runtime_error("a task needs at least one part");
  if (!replace && fs::exists(file)) throw std::runtime_error("there is a task '" + draft.name + "' already");
  const fs::path trial = folder / ("." + draft.name + ".new");
  fs::remove_all(trial);
  fs::create_directories(trial / draft.name);
  try {
    for (const auto& type : draft.types) WritePly(trial / draft.name / (type.name + ".ply"), type.mesh, 1000);
    WriteText(trial / file.filename(), TaskFileText(draft, FindContacts(draft, options), draft.name));
    LoadTask(trial / file.filename());
    fs::remove_all(meshes);
    fs::rename(trial / draft.name, meshes);
    fs::rename(trial / file.filename(), file);
  } catch (...) {
    fs::remove_all(trial);
    throw;
  }
  fs::remove_all(trial);
  return file;
}

}  // namespace coach
