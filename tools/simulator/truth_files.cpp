#include "tools/simulator/truth_files.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "tools/simulator/structure.h"

namespace coach {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPartly = 0.75, kFully = 0.05;  // visible share of what is in the image

std::ofstream Open(const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  if (!out) throw std::runtime_error(file.string() + ": can't be written");
  return out;
}

void Close(const std::filesystem::path& file, std::ofstream* out) {
  out->close();
  if (!*out) throw std::runtime_error(file.string() + ": can't be written");
}

/// Nine significant digits, nothing below a nanometre.
double Tidy(double x) {
  std::ostringstream text;
  text.precision(9);
  text << (std::abs(x) < 1e-9 ? 0.0 : x);
  return std::stod(text.str());
}

Json Rotation(const Matrix3& R) {
  Json list = Json::array();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) list.push_back(Tidy(R(r, c)));
  }
  return list;
}

Json Millimetres(const Vector3& p) { return Json::array({Tidy(1000 * p.x()), Tidy(1000 * p.y()), Tidy(1000 * p.z())}); }

Json JointOf(const Task& task, const std::string& name, const std::string& joint_class, int type_a, int type_b,
             const Pose& X_AB) {
  const PartType &a = task.types[static_cast<size_t>(type_a)], &b = task.types[static_cast<size_t>(type_b)];
  Json j{{"name", name}, {"class", joint_class}, {"a", a.name},
         {"b", b.name},  {"a_obj_id", a.bop_id}, {"b_obj_id", b.bop_id}};
  j["R"] = Rotation(X_AB.linear());
  j["t"] = Millimetres(X_AB.translation());
  SymmetryGroup discrete_a = a.symmetries, discrete_b = b.symmetries;
  discrete_a.axes.clear(), discrete_b.axes.clear();
  for (const Pose& X : Equivalents(discrete_a, X_AB, discrete_b)) {
    j["alternatives"].push_back({{"R", Rotation(X.linear())}, {"t", Millimetres(X.translation())}});
  }
  return j;
}

std::string ModelFile(int bop_id) {
  std::ostringstream name;
  name << "models/obj_";
  name.width(6);
  name.fill('0');
  name << bop_id << ".ply";
  return name.str();
}

}  // namespace

void WriteTruth(const std::filesystem::path& folder, const Scenario& scenario, const std::vector<FrameTruth>& frames) {
  auto poses = Open(folder / "scene_gt.json"), info = Open(folder / "scene_gt_info.json");
  poses << "{\n";
  info << "{\n";
  for (size_t f = 0; f < frames.size(); ++f) {
    Json gt = Json::array(), seen = Json::array();
    for (size_t i = 0; i < frames[f].parts.size(); ++i) {
      const PartTruth& p = frames[f].parts[i];
      gt.push_back({{"cam_R_m2c", Rotation(p.X_CP.linear())},
                    {"cam_t_m2c", Millimetres(p.X_CP.translation())},
                    {"obj_id", scenario.stage.task.TypeOf(static_cast<int>(i)).bop_id}});
      seen.push_back({{"bbox_obj", p.box},
                      {"bbox_visib", p.visible_box},
                      {"px_count_all", p.pixels},
                      {"px_count_in_image", p.pixels_in_image},
                      {"px_count_visib", p.pixels_visible},
                      {"visib_fract", Tidy(p.visible_fraction())}});
    }
    const std::string end = f + 1 < frames.size() ? ",\n" : "\n";
    poses << "\"" << scenario.image_ids[f] << "\": " << gt.dump() << end;
    info << "\"" << scenario.image_ids[f] << "\": " << seen.dump() << end;
  }
  poses << "}\n";
  info << "}\n";
  Close(folder / "scene_gt.json", &poses);
  Close(folder / "scene_gt_info.json", &info);
}

std::vector<TrueEvent> SightEvents(const Scenario& scenario, const std::vector<FrameTruth>& frames) {
  std::vector<TrueEvent> events;
  for (size_t i = 0; i < scenario.stage.task.parts.size(); ++i) {
    bool outside = false, partly = false, fully = false;
    for (size_t f = 0; f < frames.size(); ++f) {
      const PartTruth& p = frames[f].parts[i];
      const auto change = [&](bool now, bool* before, const char* start, const char* end, const char* level) {
        if (now == *before) return;
        *before = now;
        events.push_back({.time = scenario.frame_times[f],
                          .kind = now ? start : end,
                          .parts = {static_cast<int>(i)},
                          .level = level});
      };
      change(p.pixels_in_image == 0, &outside, "out_of_view", "in_view", "");
      if (p.pixels_in_image == 0) continue;
      const double share = static_cast<double>(p.pixels_visible) / p.pixels_in_image;
      // An end needs a little more than a start, so that the border does not flicker.
      change(share < (partly ? kPartly + 0.05 : kPartly), &partly, "occlusion_start", "occlusion_end", "partial");
      change(share < (fully ? kFully + 0.03 : kFully), &fully, "occlusion_start", "occlusion_end", "full");
    }
  }
  std::stable_sort(events.begin(), events.end(),
                   [](const TrueEvent& a, const TrueEvent& b) { return a.time < b.time; });
  return events;
}

void WriteEvents(const std::filesystem::path& folder, const Scenario& scenario, const std::vector<FrameTruth>& frames) {
  std::vector<TrueEvent> events = scenario.performance.events;
  const std::vector<TrueEvent> sight = SightEvents(scenario, frames);
  events.insert(events.end(), sight.begin(), sight.end());
  std::stable_sort(events.begin(), events.end(),
                   [](const TrueEvent& a, const TrueEvent& b) { return a.time < b.time; });
  Json list = Json::array();
  for (const TrueEvent& e : events) {
    if (scenario.frame_times.empty() || e.time > scenario.frame_times.back()) continue;
    Json j{{"time", Tidy(std::round(1e4 * e.time) / 1e4)},
           {"frame", static_cast<int>(e.time * scenario.id_rate)},
           {"type", e.kind}};
    if (!e.connection.empty()) j["connection"] = e.connection;
    j["gt"] = e.parts;
    if (!e.hand.empty()) j["hand"] = e.hand;
    if (!e.level.empty()) j["level"] = e.level;
    if (e.kind == "jolt") {
      j["duration"] = Tidy(std::round(1e3 * e.duration) / 1e3);
      j["shift_mm"] = Tidy(std::round(1e4 * e.shift) / 10);
      j["turn_deg"] = Tidy(std::round(100 * e.turn * 180 / M_PI) / 100);
    }
    list.push_back(j);
  }
  auto out = Open(folder / "events.json");
  out << Json{{"fps", scenario.id_rate}, {"events", list}}.dump(1) << "\n";
  Close(folder / "events.json", &out);
}

void WriteAssembly(const std::filesystem::path& folder, const Scenario& scenario, const std::vector<HsvRange>& ranges) {
  const Task& task = scenario.stage.task;
  const std::vector<std::string> classes = JointClasses(task);
  Json parts = Json::array();
  std::vector<int> count(task.types.size(), 0);
  for (size_t i = 0; i < task.parts.size(); ++i) {
    const size_t type = static_cast<size_t>(task.parts[i].type);
    const HsvRange& range = ranges[type];
    parts.push_back({{"name", task.parts[i].name},
                     {"type", task.types[type].name},
                     {"obj_id", task.types[type].bop_id},
                     {"gt_index", i},
                     {"instance", count[type]++},
                     {"mesh", ModelFile(task.types[type].bop_id)},
                     {"colour", task.types[type].colour},
                     {"hsv_lo", range.low},
                     {"hsv_hi", range.high},
                     {"hue_wraps", range.low[0] > range.high[0]}});
  }
  Json connections = Json::array(), wrong = Json::array();
  for (const int c : OwnConnections(task)) {
    const Connection& joint = task.connections[static_cast<size_t>(c)];
    Json j =
        JointOf(task, joint.name, classes[static_cast<size_t>(c)], task.slots[static_cast<size_t>(joint.slot_a)].type,
                task.slots[static_cast<size_t>(joint.slot_b)].type, joint.X_AB);
    j["node_a"] = joint.slot_a;
    j["node_b"] = joint.slot_b;
    j["closes_by_itself"] = joint.closes_by_itself;
    connections.push_back(j);
  }
  for (size_t m = 0; m < task.mistakes.size(); ++m) {
    const Mistake& mistake = task.mistakes[m];
    wrong.push_back(JointOf(task, mistake.name, classes[task.connections.size() + m], mistake.type_a, mistake.type_b,
                            mistake.X_AB));
  }
  Json steps = Json::array();
  for (int s : task.steps) steps.push_back(task.connections[static_cast<size_t>(s)].name);
  const Json root{{"scenario", scenario.options.name},
                  {"task", task.name},
                  {"seed", scenario.options.seed},
                  {"fps", scenario.id_rate},
                  {"units", "mm"},
                  {"models_dir", "models"},
                  {"parts", parts},
                  {"connections", connections},
                  {"wrong_connections", wrong},
                  {"steps", steps}};
  auto out = Open(folder / "assembly.json");
  out << root.dump(1) << "\n";
  Close(folder / "assembly.json", &out);
}

void WriteTask(const std::filesystem::path& folder, const Task& task, const std::vector<HsvRange>& ranges) {
  // The task's own file, so that nothing of it is lost; only the meshes and the colours are those of the scene.
  YAML::Node root = YAML::LoadFile(task.file);
  for (size_t t = 0; t < task.types.size(); ++t) {
    YAML::Node part = root["parts"][t];
    part["mesh"] = ModelFile(task.types[t].bop_id);
    part["mesh_units"] = "mm";
    part["bop_id"] = task.types[t].bop_id;
    YAML::Node hsv;
    hsv.SetStyle(YAML::EmitterStyle::Flow);
    for (const int x : ranges[t].low) hsv["low"].push_back(x);
    for (const int x : ranges[t].high) hsv["high"].push_back(x);
    part["hsv"] = hsv;
  }
  auto out = Open(folder / "task.yaml");
  out << root << "\n";
  Close(folder / "task.yaml", &out);
}

void WriteModels(const std::filesystem::path& folder, const Task& task) {
  std::filesystem::create_directories(folder / "models");
  Json info;
  for (const PartType& type : task.types) {
    WritePly(folder / ModelFile(type.bop_id), type.mesh, 1000);
    const MeshExtent e = Extent(type.mesh);
    Json& j = info[std::to_string(type.bop_id)];
    j["diameter"] = Tidy(1000 * e.diameter);
    const char* axes = "xyz";
    for (int i = 0; i < 3; ++i) j[std::string("min_") + axes[i]] = Tidy(1000 * e.low[i]);
    for (int i = 0; i < 3; ++i) j[std::string("size_") + axes[i]] = Tidy(1000 * (e.high[i] - e.low[i]));
    for (size_t s = 1; s < type.symmetries.discrete.size(); ++s) {
      const Matrix3& R = type.symmetries.discrete[s];
      Json matrix = Json::array();
      for (int r = 0; r < 4; ++r) {
        for (int c = 0; c < 4; ++c) matrix.push_back(r < 3 && c < 3 ? Tidy(R(r, c)) : (r == c ? 1.0 : 0.0));
      }
      j["symmetries_discrete"].push_back(matrix);
    }
    for (const Vector3& axis : type.symmetries.axes) {
      j["symmetries_continuous"].push_back(
          {{"axis", {Tidy(axis.x()), Tidy(axis.y()), Tidy(axis.z())}}, {"offset", {0, 0, 0}}});
    }
  }
  auto out = Open(folder / "models" / "models_info.json");
  out << info.dump(1) << "\n";
  Close(folder / "models" / "models_info.json", &out);
}

}  // namespace coach
