#include "common/assembly/task_file.h"

#include <openssl/evp.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "common/assembly/task_check.h"
#include "common/configuration/yaml_reader.h"

namespace coach {
namespace {

constexpr double kRadians = std::numbers::pi / 180;
/// A model's symmetry may be this far off its origin (m): measured models are centred by their box, not by their axis.
constexpr double kLargestSymmetryOffset = 0.002;

std::string Sha256(const std::string& bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr);
  std::string hex;
  for (unsigned int i = 0; i < length; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    hex += kDigits[digest[i] >> 4];
    hex += kDigits[digest[i] & 15];
  }
  return hex;
}

std::string Slurp(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

std::string Name(const YamlNode& node) {
  auto name = node.As<std::string>();
  const bool good = !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!good) node.Fail("a name of 1 to 64 letters, digits, - or _");
  return name;
}

/// Index of the item called `name`, or a failure that lists what there is.
template <class Items>
int IndexOf(const Items& items, const YamlNode& node, const char* what) {
  const auto name = node.As<std::string>();
  std::string known;
  for (size_t i = 0; i < items.size(); ++i) {
    if (items[i].name == name) return static_cast<int>(i);
    known += (known.empty() ? "" : ", ") + items[i].name;
  }
  node.Fail(std::string("the name of a ") + what + " (" + (known.empty() ? "there is none" : known) + ")");
}

template <class Items>
void RejectSecond(const Items& items, const std::string& name, const YamlNode& node) {
  if (std::any_of(items.begin(), items.end(), [&](const auto& item) { return item.name == name; }))
    node.Fail("a name that is not used twice");
}

Eigen::VectorXd Numbers(const YamlNode& node, int n) {
  const auto values = node.As<std::vector<double>>();
  if (static_cast<int>(values.size()) != n) node.Fail("a list of " + std::to_string(n) + " numbers");
  return Eigen::Map<const Eigen::VectorXd>(values.data(), n);
}

Matrix3 Rotation(const YamlNode& node) {
  const Eigen::VectorXd v = Numbers(node, 9);
  Matrix3 R;
  R << v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8];
  if (!((R * R.transpose() - Matrix3::Identity()).norm() < 2e-3) || R.determinant() < 0)
    node.Fail("a rotation matrix, row major");
  return MakePose(R, Vector3::Zero()).linear();
}

/// Metres per unit of a key that says mm or m.
double Units(const YamlNode& node, const std::string& key, const std::string& otherwise) {
  return node.GetChoice(key, otherwise, {"mm", "m"}) == "m" ? 1.0 : 0.001;
}

HsvRange ReadHsv(const YamlNode& node) {
  HsvRange range;
  const auto read = [&](const char* key, std::array<int, 3>& out) {
    const YamlNode list = node.At(key);
    const auto values = list.As<std::vector<int>>();
    if (values.size() != 3) list.Fail("three whole numbers: hue, saturation, value");
    for (size_t i = 0; i < 3; ++i) {
      if (values[i] < 0 || values[i] > (i == 0 ? 179 : 255)) list.Fail("hue 0..179, saturation and value 0..255");
      out[i] = values[i];
    }
  };
  read("low", range.low);
  read("high", range.high);
  for (size_t i = 1; i < 3; ++i) {
    if (range.low[i] > range.high[i]) node.Fail("low saturation and value not above the high ones (only hue wraps)");
  }
  node.RejectUnknownKeys();
  return range;
}

SymmetryGroup ReadSymmetries(const YamlNode& node) {
  std::vector<Matrix3> discrete;
  std::vector<Vector3> axes;
  if (const auto list = node.Find("discrete")) {
    for (const YamlNode& item : list->Items()) discrete.push_back(Rotation(item));
  }
  if (const auto list = node.Find("continuous")) {
    for (const YamlNode& item : list->Items()) axes.emplace_back(Numbers(item, 3));
  }
  node.RejectUnknownKeys();
  try {
    return MakeSymmetryGroup(discrete, axes);
  } catch (const std::invalid_argument& e) {
    node.Fail(e.what(), "rotations of the part onto itself");
  }
}

/// Symmetries of object `bop_id` from a BOP models_info.json; none if the file or the object is missing.
SymmetryGroup ReadModelsInfo(const std::filesystem::path& file, int bop_id) {
  if (bop_id == 0 || !std::filesystem::exists(file)) return {};
  try {
    const nlohmann::json all = nlohmann::json::parse(Slurp(file));
    const auto found = all.find(std::to_string(bop_id));
    if (found == all.end()) return {};
    std::vector<Matrix3> discrete;
    std::vector<Vector3> axes;
    const auto check_offset = [](double mm) {
      if (!(std::abs(mm) * 0.001 <= kLargestSymmetryOffset))
        throw std::invalid_argument("a symmetry is not about the model's origin");
    };
    if (found->contains("symmetries_discrete")) {
      for (const auto& item : found->at("symmetries_discrete")) {
        const auto v = item.get<std::array<double, 16>>();
        Matrix3 R;
        R << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
        for (const size_t i : {3u, 7u, 11u}) check_offset(v[i]);
        discrete.push_back(R);
      }
    }
    if (found->contains("symmetries_continuous")) {
      for (const auto& item : found->at("symmetries_continuous")) {
        const auto axis = item.at("axis").get<std::array<double, 3>>();
        const auto offset = item.value("offset", std::array<double, 3>{0, 0, 0});
        axes.emplace_back(axis[0], axis[1], axis[2]);
        check_offset(Vector3(offset[0], offset[1], offset[2]).cross(axes.back().normalized()).norm());
      }
    }
    return MakeSymmetryGroup(discrete, axes);
  } catch (const std::exception& e) {
    throw ConfigurationError(file.string() + ": object " + std::to_string(bop_id) + ": " + e.what());
  }
}

PartType ReadType(const YamlNode& node, const Task& task, const std::filesystem::path& folder, double unit,
                  const TaskFileOptions& options) {
  PartType type;
  type.name = Name(node.At("type"));
  RejectSecond(task.types, type.name, node.At("type"));
  type.count = node.Get<int>("count", 1);
  if (type.count < 1 || type.count > 100) node.At("count").Fail("a count from 1 to 100");
  type.bop_id = node.Get<int>("bop_id", 0);
  if (type.bop_id < 0) node.At("bop_id").Fail("a whole number from 1");
  for (const PartType& other : task.types) {
    if (type.bop_id != 0 && other.bop_id == type.bop_id) node.At("bop_id").Fail("a number that is not used twice");
  }
  type.colour = node.Get<std::string>("colour", "");
  type.hsv = ReadHsv(node.At("hsv"));
  const YamlNode mesh = node.At("mesh");
  type.mesh_file = std::filesystem::absolute(folder / mesh.As<std::string>()).lexically_normal();
  if (!std::filesystem::is_regular_file(type.mesh_file)) mesh.Fail("a mesh file beside the task file");
  const double mesh_unit = Units(node, "mesh_units", unit == 1.0 ? "m" : "mm");
  try {
    if (options.read_meshes) type.mesh = ReadMesh(type.mesh_file, mesh_unit);
  } catch (const std::exception& e) {
    mesh.Fail(e.what(), "a mesh that can be read");
  }
  const auto symmetries = node.Find("symmetries");
  type.symmetries = symmetries ? ReadSymmetries(*symmetries)
                               : ReadModelsInfo(type.mesh_file.parent_path() / "models_info.json", type.bop_id);
  node.RejectUnknownKeys();
  return type;
}

JointFreedom ReadFreedom(const YamlNode& node, double unit) {
  JointFreedom freedom;
  const bool rotation = node.GetChoice("kind", "rotation", {"rotation", "translation"}) == "rotation";
  freedom.kind = rotation ? JointFreedom::Kind::kRotation : JointFreedom::Kind::kTranslation;
  const YamlNode axis = node.At("axis");
  freedom.axis = Numbers(axis, 3);
  if (!(freedom.axis.norm() > 1e-9)) axis.Fail("a direction");
  freedom.axis.normalize();
  if (const auto point = node.Find("point")) freedom.point = Numbers(*point, 3) * unit;
  const double scale = rotation ? kRadians : unit;
  freedom.low = node.Get<double>("low") * scale;
  freedom.high = node.Get<double>("high") * scale;
  if (!(freedom.low < freedom.high)) node.Fail("low below high");
  node.RejectUnknownKeys();
  return freedom;
}

Pose ReadPose(const YamlNode& node, double unit) {
  return MakePose(Rotation(node.At("rotation")), Numbers(node.At("translation"), 3) * unit);
}

std::vector<YamlNode> Two(const YamlNode& list) {
  auto items = list.Items();
  if (items.size() != 2) list.Fail("two names");
  return items;
}

void ReadConnection(const YamlNode& node, double unit, Task& task) {
  Connection c;
  c.name = Name(node.At("name"));
  RejectSecond(task.connections, c.name, node.At("name"));
  RejectSecond(task.mistakes, c.name, node.At("name"));
  const auto slots = Two(node.At("slots"));
  c.slot_a = IndexOf(task.slots, slots[0], "slot");
  c.slot_b = IndexOf(task.slots, slots[1], "slot");
  if (c.slot_a == c.slot_b) node.At("slots").Fail("two different slots");
  c.X_AB = ReadPose(node, unit);
  c.closes_by_itself = node.Get<bool>("closes_by_itself", false);
  if (const auto list = node.Find("freedom")) {
    for (const YamlNode& item : list->Items()) c.freedom.push_back(ReadFreedom(item, unit));
    if (c.freedom.size() > 5) list->Fail("at most 5 freedoms (6 would be no connection)");
  }
  node.RejectUnknownKeys();
  task.connections.push_back(c);
}

void ReadMistake(const YamlNode& node, double unit, Task& task) {
  Mistake m;
  m.name = Name(node.At("name"));
  if (m.name == "unknown") node.At("name").Fail("another name: 'unknown' stands for contacts on no list");
  RejectSecond(task.connections, m.name, node.At("name"));
  RejectSecond(task.mistakes, m.name, node.At("name"));
  const auto types = Two(node.At("types"));
  m.type_a = IndexOf(task.types, types[0], "part type");
  m.type_b = IndexOf(task.types, types[1], "part type");
  m.X_AB = ReadPose(node, unit);
  node.RejectUnknownKeys();
  task.mistakes.push_back(m);
}

/// A variant lists connections: names of earlier ones or new ones written out.
std::vector<int> ReadVariant(const YamlNode& node, double unit, Task& task) {
  std::vector<int> set;
  for (const YamlNode& item : node.At("connections").Items()) {
    if (item.IsMap()) {
      ReadConnection(item, unit, task);
      set.push_back(static_cast<int>(task.connections.size()) - 1);
    } else {
      set.push_back(IndexOf(task.connections, item, "connection"));
    }
  }
  if (set.empty()) node.Fail("at least one connection");
  Name(node.At("name"));
  node.RejectUnknownKeys();
  std::sort(set.begin(), set.end());
  if (std::adjacent_find(set.begin(), set.end()) != set.end()) node.At("connections").Fail("each connection once");
  return set;
}

void ReadSlots(const YamlNode& root, Task& task) {
  const auto list = root.Find("slots");
  if (!list) return;
  std::vector<int> used(task.types.size(), 0);
  for (const YamlNode& node : list->Items()) {
    Slot slot;
    slot.name = Name(node.At("name"));
    RejectSecond(task.slots, slot.name, node.At("name"));
    slot.type = IndexOf(task.types, node.At("type"), "part type");
    node.RejectUnknownKeys();
    if (++used[slot.type] > task.types[slot.type].count)
      node.Fail("not more slots of type " + task.types[slot.type].name + " than its count (" +
                std::to_string(task.types[slot.type].count) + "): this one could never be filled");
    task.slots.push_back(slot);
  }
}

void ReadSteps(const YamlNode& root, Task& task) {
  if (const auto list = root.Find("steps")) {
    for (const YamlNode& node : list->Items()) {
      const int step = IndexOf(task.connections, node, "connection");
      const auto& own = task.variants.at(0);
      if (std::find(own.begin(), own.end(), step) == own.end())
        node.Fail("a connection of the task's own set, not of a variant");
      if (std::find(task.steps.begin(), task.steps.end(), step) != task.steps.end()) node.Fail("each step once");
      task.steps.push_back(step);
    }
  } else if (!task.variants.empty()) {
    for (const int c : task.variants[0]) {
      if (!task.connections[c].closes_by_itself) task.steps.push_back(c);
    }
  }
}

void ReadStructure(const YamlNode& root, double unit, const TaskFileOptions& options, Task& task) {
  ReadSlots(root, task);
  std::vector<YamlNode> places;
  if (const auto list = root.Find("connections")) {
    for (const YamlNode& node : list->Items()) ReadConnection(node, unit, task);
    if (!task.connections.empty()) {
      places.push_back(*list);
      auto& own = task.variants.emplace_back();
      for (size_t i = 0; i < task.connections.size(); ++i) own.push_back(static_cast<int>(i));
    }
  }
  if (const auto list = root.Find("mistakes")) {
    for (const YamlNode& node : list->Items()) ReadMistake(node, unit, task);
  }
  if (const auto list = root.Find("variants")) {
    if (task.connections.empty()) list->Fail("no variants without connections");
    for (const YamlNode& node : list->Items()) {
      task.variants.push_back(ReadVariant(node, unit, task));
      places.push_back(node);
    }
  }
  for (size_t v = 0; v < task.variants.size(); ++v) {
    const std::string problem =
        RingProblem(task, task.variants[v], options.ring_position_tolerance, options.ring_angle_tolerance);
    if (!problem.empty()) places[v].Fail(problem, "rings whose relative poses compose to the identity");
  }
  ReadSteps(root, task);
}

}  // namespace

Task LoadTask(const std::filesystem::path& file, const TaskFileOptions& options) {
  const YamlNode root = YamlNode::Load(file);
  Task task;
  task.file = std::filesystem::absolute(file).lexically_normal();
  task.sha256 = Sha256(Slurp(file));
  task.name = Name(root.At("name"));
  const double unit = Units(root, "units", "mm");
  const YamlNode types = root.At("parts");
  for (const YamlNode& node : types.Items())
    task.types.push_back(ReadType(node, task, task.file.parent_path(), unit, options));
  if (task.types.empty()) types.Fail("at least one part");
  for (size_t t = 0; t < task.types.size(); ++t) {
    for (int i = 1; i <= task.types[t].count; ++i)
      task.parts.push_back({task.types[t].name + "_" + std::to_string(i), static_cast<int>(t)});
  }
  ReadStructure(root, unit, options, task);
  root.RejectUnknownKeys();
  return task;
}

}  // namespace coach
