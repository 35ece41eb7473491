#include "tools/simulator/making.h"

#include <algorithm>
#include <stdexcept>

#include "tools/simulator/enactment.h"

namespace coach {
namespace {

/// Types without a number get the first free ones.
void NumberTypes(Task* task) {
  const auto taken = [&](int id) {
    return std::any_of(task->types.begin(), task->types.end(), [&](const PartType& type) { return type.bop_id == id; });
  };
  int free_id = 1;
  for (PartType& type : task->types) {
    while (taken(free_id)) ++free_id;
    if (type.bop_id == 0) type.bop_id = free_id;
  }
}

}  // namespace

Making::Making(const Task& t, const ScenarioOptions& options)
    : task(scenario.stage.task), random(options.seed), style(StyleByName(options.style)) {
  scenario.options = options;
  scenario.stage.task = t;
  NumberTypes(&task);
  for (size_t i = 0; i < t.parts.size(); ++i) {
    const PartType& type = t.TypeOf(static_cast<int>(i));
    scenario.meshes.push_back(type.mesh);
    scenario.stage.part_materials.push_back(PartMaterial(type.hsv));
  }
  structure = FinishedStructure(t);
  camera.width = options.width;
  camera.height = options.height;
}

void Making::AddProp(const TriangleMesh& mesh, const Pose& X_W) {
  Material m;
  m.colour = FromSrgb(150, 110, 80), m.second_colour = FromSrgb(90, 70, 60), m.pattern = 3, m.tile = 0.15;
  scenario.stage.props.push_back({mesh, m});
  scenario.meshes.push_back(mesh);
  props_at.push_back(X_W);
}

void Making::Furnish(const RoomOptions& room) {
  Stage& stage = scenario.stage;
  stage.room = MakeRoom(room, random);
  const double scale = camera.width / 640.0;
  camera.fx = scale * random.Uniform(518, 532);
  camera.fy = camera.fx * random.Uniform(0.998, 1.002);
  camera.cx = scale * (319.5 + random.Uniform(-5, 5));
  camera.cy = 0.5 * (camera.height - 1) + scale * random.Uniform(-4, 4);
  stage.camera = camera;
  scenario.camera.azimuth = random.Uniform(-0.12, 0.12);
  scenario.camera.elevation = random.Uniform(0.7, 0.88);
  scenario.camera.distance = random.Uniform(0.96, 1.08);
  scenario.camera.roll = random.Uniform(-0.03, 0.03);
  scenario.camera.phase = random.Uniform(0, 6);
  solids = std::make_unique<Solids>(scenario.meshes);
}

void Making::Place(std::vector<Pose> parts) {
  parts.insert(parts.end(), props_at.begin(), props_at.end());
  scenario.performance = Performance(std::move(parts), {HomeOf(Side::kLeft), HomeOf(Side::kRight)});
  child = std::make_unique<Child>(task, *solids, style, &scenario.performance, &random);
}

void Making::Scatter(double any_face) {
  Task loose;  // nothing to build
  loose.types = task.types;
  loose.parts = task.parts;
  Place(ScatterParts(loose, *solids, {}, Pose::Identity(), scenario.stage.room.clutter, any_face, random));
}

Pose Flat(const Making& m, int part, double x, double y, double yaw) {
  Matrix3 R = Eigen::AngleAxisd(yaw, Vector3::UnitZ()).toRotationMatrix();
  for (size_t slot = 0; slot < m.structure.part.size(); ++slot) {
    if (m.structure.part[slot] == part && m.structure.reached[slot]) {
      const Vector3 up = m.structure.X_slot[slot].linear().transpose() * Vector3::UnitZ();
      R = R * Eigen::Quaterniond::FromTwoVectors(up, Vector3::UnitZ()).toRotationMatrix();
    }
  }
  return MakePose(R, Vector3(x, y, -m.solids->Lowest(part, R)));
}

std::pair<int, int> EqualParts(const Task& task) {
  for (size_t i = 0; i < task.parts.size(); ++i) {
    for (size_t j = i + 1; j < task.parts.size(); ++j) {
      if (task.parts[i].type == task.parts[j].type) return {static_cast<int>(i), static_cast<int>(j)};
    }
  }
  throw std::invalid_argument("scenario: task " + task.name + " has no two equal parts");
}

}  // namespace coach
