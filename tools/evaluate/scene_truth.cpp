#include "tools/evaluate/scene_truth.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "common/geometry/mesh.h"

namespace coach {
namespace {

using Json = nlohmann::json;

constexpr int kSurfacePoints = 250;

Json Read(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + ": can't be read");
  try {
    return Json::parse(in);
  } catch (const Json::exception& e) {
    throw std::runtime_error(file.string() + ": " + e.what());
  }
}

Matrix3 Rotation(const Json& list) {
  Matrix3 R;
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = list.at(static_cast<size_t>(i)).get<double>();
  return R;
}

Vector3 Vector(const Json& list) {
  return {list.at(0).get<double>(), list.at(1).get<double>(), list.at(2).get<double>()};
}

TrueObject ReadObject(const std::filesystem::path& folder, int obj_id, const Json& info) {
  TrueObject object;
  object.obj_id = obj_id;
  std::string number = std::to_string(obj_id);
  number.insert(0, 6 - std::min<size_t>(6, number.size()), '0');
  const TriangleMesh mesh = ReadMesh(folder / "models" / ("obj_" + number + ".ply"), 0.001);
  for (const SurfacePoint& s : SampleSurface(mesh, kSurfacePoints)) object.surface.push_back(s.p);
  std::vector<Matrix3> discrete;
  std::vector<Vector3> axes;
  for (const Json& m : info.value("symmetries_discrete", Json::array())) {
    Matrix3 R;
    for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = m.at(static_cast<size_t>(4 * (i / 3) + i % 3)).get<double>();
    discrete.push_back(R);
  }
  for (const Json& a : info.value("symmetries_continuous", Json::array())) axes.push_back(Vector(a.at("axis")));
  object.symmetries = MakeSymmetryGroup(discrete, axes);
  return object;
}

void ReadFrames(const std::filesystem::path& folder, SceneTruth* truth) {
  const Json gt = Read(folder / "scene_gt.json"), info = Read(folder / "scene_gt_info.json");
  const Json models = Read(folder / "models" / "models_info.json");
  for (const auto& [id, unused] : gt.items()) truth->image_ids.push_back(std::stoi(id));
  std::sort(truth->image_ids.begin(), truth->image_ids.end());
  if (truth->image_ids.empty()) throw std::runtime_error((folder / "scene_gt.json").string() + ": no frame");
  for (const Json& object : gt.at(std::to_string(truth->image_ids[0]))) {
    const int obj_id = object.at("obj_id").get<int>();
    truth->objects.push_back(ReadObject(folder, obj_id, models.at(std::to_string(obj_id))));
  }
  for (const int id : truth->image_ids) {
    const Json &objects = gt.at(std::to_string(id)), &seen = info.at(std::to_string(id));
    if (objects.size() != truth->objects.size() || seen.size() != truth->objects.size()) {
      throw std::runtime_error((folder / "scene_gt.json").string() + ": frame " + std::to_string(id) + ": found " +
                               std::to_string(objects.size()) + " objects, expected " +
                               std::to_string(truth->objects.size()));
    }
    auto& poses = truth->X_CP.emplace_back();
    auto& visible = truth->visible.emplace_back();
    for (size_t k = 0; k < objects.size(); ++k) {
      poses.push_back(MakePose(Rotation(objects[k].at("cam_R_m2c")), 0.001 * Vector(objects[k].at("cam_t_m2c"))));
      visible.push_back(seen[k].at("visib_fract").get<double>());
    }
  }
}

}  // namespace

std::vector<std::vector<int>> SceneTruth::Kinds() const {
  std::map<int, std::vector<int>> kinds;
  for (int k = 0; k < parts(); ++k) kinds[objects[static_cast<size_t>(k)].obj_id].push_back(k);
  std::vector<std::vector<int>> list;
  for (const auto& [id, members] : kinds) list.push_back(members);
  return list;
}

SceneTruth ReadSceneTruth(const std::filesystem::path& folder) {
  SceneTruth truth;
  truth.folder = folder.string();
  try {
    ReadFrames(folder, &truth);
    const Json assembly = Read(folder / "assembly.json"), events = Read(folder / "events.json");
    truth.scenario = assembly.value("scenario", "");
    truth.fps = assembly.at("fps").get<double>();
    for (const char* list : {"connections", "wrong_connections"}) {
      for (const Json& c : assembly.value(list, Json::array())) {
        truth.joint_class[c.at("name").get<std::string>()] = c.at("class").get<std::string>();
      }
    }
    for (const Json& part : assembly.at("parts")) {
      const size_t k = part.at("gt_index").get<size_t>();
      if (k < truth.objects.size()) truth.objects[k].name = part.at("name").get<std::string>();
    }
    for (const Json& e : events.at("events")) {
      truth.events.push_back({e.at("time").get<double>(), e.at("type").get<std::string>(), e.value("connection", ""),
                              e.value("gt", std::vector<int>{}), e.value("duration", 0.0)});
    }
  } catch (const Json::exception& e) {
    throw std::runtime_error(folder.string() + ": " + e.what());
  }
  return truth;
}

}  // namespace coach
