#include "tools/simulator/scenario.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>

#include "tools/simulator/enactment.h"
#include "tools/simulator/shapes.h"

namespace coach {
namespace {

/// What a scenario is made of while it is being made.
struct Making {
  Making(const Task& t, const ScenarioOptions& options)
      : task(scenario.stage.task), random(options.seed), style(StyleByName(options.style)) {
    scenario.options = options;
    scenario.stage.task = t;
    for (size_t i = 0, free_id = 1; i < task.types.size(); ++i) {
      const auto taken = [&] {
        return std::any_of(task.types.begin(), task.types.end(),
                           [&](const PartType& type) { return type.bop_id == static_cast<int>(free_id); });
      };
      while (taken()) ++free_id;
      if (task.types[i].bop_id == 0) task.types[i].bop_id = static_cast<int>(free_id);
    }
    for (size_t i = 0; i < t.parts.size(); ++i) {
      const PartType& type = t.TypeOf(static_cast<int>(i));
      scenario.meshes.push_back(type.mesh);
      scenario.stage.part_materials.push_back(PartMaterial(type.hsv));
    }
    structure = FinishedStructure(t);
    camera = Camera(options);
  }

  static CameraModel Camera(const ScenarioOptions& options) {
    CameraModel camera;
    camera.width = options.width;
    camera.height = options.height;
    return camera;
  }

  void AddProp(const TriangleMesh& mesh, const Pose& X_W) {
    Material m;
    m.colour = FromSrgb(150, 110, 80), m.second_colour = FromSrgb(90, 70, 60), m.pattern = 3, m.tile = 0.15;
    scenario.stage.props.push_back({mesh, m});
    scenario.meshes.push_back(mesh);
    props_at.push_back(X_W);
  }

  /// Room, camera and sensors; then the things at their places and the child with its hands at home.
  void Furnish(const RoomOptions& room) {
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

  void Place(std::vector<Pose> parts) {
    parts.insert(parts.end(), props_at.begin(), props_at.end());
    scenario.performance = Performance(std::move(parts), {HomeOf(Side::kLeft), HomeOf(Side::kRight)});
    child = std::make_unique<Child>(task, *solids, style, &scenario.performance, &random);
  }

  /// Scattered parts; nothing is going to be built.
  void Scatter(double any_face) {
    Task loose = task;
    loose.connections.clear();
    const Structure none = FinishedStructure(loose);
    Place(ScatterParts(loose, *solids, none, Pose::Identity(), scenario.stage.room.clutter, any_face, random));
  }

  Scenario scenario;
  Task& task;
  Random random;
  ChildStyle style;
  Structure structure;
  CameraModel camera;
  std::vector<Pose> props_at;
  std::unique_ptr<Solids> solids;
  std::unique_ptr<Child> child;
};

Pose Flat(const Making& m, int part, double x, double y, double yaw) {
  Matrix3 R = Eigen::AngleAxisd(yaw, Vector3::UnitZ()).toRotationMatrix();
  for (size_t slot = 0; slot < m.structure.part.size(); ++slot) {
    if (m.structure.part[slot] == part && m.structure.reached[slot]) {
      // Upright as in the structure, but with the part's own x along the yaw.
      const Vector3 up = m.structure.X_slot[slot].linear().transpose() * Vector3::UnitZ();
      R = R * Eigen::Quaterniond::FromTwoVectors(up, Vector3::UnitZ()).toRotationMatrix();
    }
  }
  return MakePose(R, Vector3(x, y, -m.solids->Lowest(part, R)));
}

/// The first part of its kind that has an equal, and that equal.
std::pair<int, int> EqualParts(const Task& task) {
  for (size_t i = 0; i < task.parts.size(); ++i) {
    for (size_t j = i + 1; j < task.parts.size(); ++j) {
      if (task.parts[i].type == task.parts[j].type) return {static_cast<int>(i), static_cast<int>(j)};
    }
  }
  throw std::invalid_argument("scenario: task " + task.name + " has no two equal parts");
}

// ---------------------------------------------------------------- lessons

void Build(Making* m) {
  m->Furnish({});
  const Random start = m->random;
  const ChildStyle style = m->style;
  // Interludes are left out, the least important first, and then the child works faster, until the lesson fits.
  for (int left_out = 0; left_out < 9; ++left_out) {
    m->random = start;
    m->style = style;
    LessonPlan plan;
    plan.mistakes = m->scenario.options.mistakes;
    plan.out_of_view = left_out < 1;
    plan.turn = left_out < 2;
    plan.near_miss = left_out < 3;
    plan.cover = left_out < 4;
    if (left_out >= 5) plan.mistakes = 0;
    if (left_out > 4) m->style.speed *= std::pow(1.3, left_out - 4), m->style.pause *= std::pow(0.6, left_out - 4);
    const Pose place = StructurePlace(m->task, m->structure, *m->solids, m->random);
    m->Place(ScatterParts(m->task, *m->solids, m->structure, place, m->scenario.stage.room.clutter, 0.3, m->random));
    m->child->set_now(1.2);
    Enactment(m->task, m->structure, *m->solids, m->child.get(), &m->scenario.performance, &m->random).Play(plan);
    const double limit = m->scenario.options.seconds;
    if (limit <= 0 || m->child->now() <= limit) break;
  }
}

void Ready(Making* m) {
  m->Furnish({});
  const Pose place = StructurePlace(m->task, m->structure, *m->solids, m->random);
  m->Place(ScatterParts(m->task, *m->solids, m->structure, place, m->scenario.stage.room.clutter, 0.2, m->random));
  m->child->set_now(3);
}

void BuildWithJolts(Making* m) {
  Build(m);
  m->scenario.camera.tremor = 0.001;
  for (double t = 3; t < m->child->now(); t += m->random.Uniform(4, 7)) {
    const double duration = m->random.Uniform(0.12, 0.25);
    const Vector3 shift(m->random.Uniform(-0.06, 0.06), m->random.Uniform(-0.04, 0.04), m->random.Uniform(-0.03, 0.04));
    const Vector3 turn(m->random.Uniform(-0.06, 0.06), m->random.Uniform(-0.06, 0.06), m->random.Uniform(-0.06, 0.06));
    m->scenario.camera.jolts.push_back({t, duration, shift, turn});
  }
}

void BuildOfShinyParts(Making* m) {
  Build(m);
  for (Material& material : m->scenario.stage.part_materials) material.depth_holes = 0.4, material.gloss = 0.6;
}

void BuildOfOneColour(Making* m) {
  for (Material& material : m->scenario.stage.part_materials) material = m->scenario.stage.part_materials[0];
  Build(m);
}

void BuildNoisy(Making* m) {
  Build(m);
  m->scenario.stage.depth.noise = 2;
  m->scenario.stage.colour.noise = 2;
}

// ---------------------------------------------------------------- the paper's Fig. 4

void Fig4(Making* m) {
  m->scenario.stage.child = false;
  m->AddProp(MakeBox({0.14, 0.05, 0.17}),
             OnTable(m->random.Uniform(-0.03, 0.03), -0.17, 0.085, m->random.Uniform(-0.2, 0.2)));
  m->Furnish({.clutter = 5, .clutter_from = 0.25});
  const int n = static_cast<int>(m->task.parts.size());
  std::vector<Pose> poses;
  for (int i = 0; i < n; ++i) {
    // Side by side in a row behind the obstacle, about 10 cm from one another.
    const double x = (i - 0.5 * (n - 1)) * 0.11 + m->random.Uniform(-0.01, 0.01);
    poses.push_back(Flat(*m, i, x, 0.03 + m->random.Uniform(-0.02, 0.02), 0.5 * M_PI + m->random.Uniform(-0.4, 0.4)));
  }
  m->Place(poses);
  CameraPath& path = m->scenario.camera;
  path.target = {0, 0.02, 0.02};
  path.distance = 0.9;
  path.swing = 1;
  path.azimuth = 0.25;
  path.elevation = 0.68;
  path.period = m->random.Uniform(10, 13);
  path.tremor = 0.0012;
  const double end = m->scenario.options.seconds > 0 ? m->scenario.options.seconds : 30;
  for (double t = m->random.Uniform(5, 7); t < end; t += m->random.Uniform(6, 8)) {
    const auto push = [&](double most) {
      return (m->random.Chance(0.5) ? 1 : -1) * m->random.Uniform(0.5 * most, most);
    };
    path.jolts.push_back(
        {t, m->random.Uniform(0.14, 0.25), {push(0.09), push(0.06), push(0.06)}, {push(0.07), push(0.07), push(0.05)}});
  }
  m->child->set_now(end);
}

void Start(Making* m) {
  m->scenario.stage.child = false;
  m->Furnish({.clutter = 3});
  m->Scatter(0.5);
  m->scenario.camera.tremor = 0;
  m->child->set_now(1.5);
}

// ---------------------------------------------------------------- hard cases

/// A screen that a hand puts in front of a part and takes away again.
struct Screen {
  static constexpr double kHeight = 0.17;
  int thing = 0;
  Pose away, hiding;
};

Screen AddScreen(Making* m, double width, double x, double y) {
  Screen s;
  s.thing = static_cast<int>(m->scenario.meshes.size());
  s.away = OnTable(-0.42, -0.02, 0.5 * Screen::kHeight, 0.9);
  s.hiding = OnTable(x, y, 0.5 * Screen::kHeight, 0);
  m->AddProp(MakeBox({width, 0.03, Screen::kHeight}), s.away);
  return s;
}

std::vector<Pose> Row(const Making& m, double y) {
  std::vector<Pose> poses;
  const int n = static_cast<int>(m.task.parts.size());
  for (int i = 0; i < n; ++i)
    poses.push_back(Flat(m, i, i == 0 ? 0.05 : 0.05 + 0.085 * i, i == 0 ? y : 0.13, i == 0 ? 0.0 : 1.5));
  return poses;
}

void HiddenStill(Making* m) {
  const Screen screen = AddScreen(m, 0.3, 0.05, -0.13);
  m->Furnish({});
  m->Place(Row(*m, -0.065));
  for (int i = 0; i < 2; ++i) {
    m->child->Reach(Side::kRight, screen.thing);
    m->child->Carry(Side::kRight, screen.hiding, 0.05);
    m->child->Wait(2.2);
    m->child->Carry(Side::kRight, screen.away, 0.05);
    m->child->Release(Side::kRight);
    m->child->Wait(1.5);
  }
}

void HiddenMoving(Making* m) {
  const Screen screen = AddScreen(m, 0.42, 0.05, -0.13);
  m->Furnish({});
  m->Place(Row(*m, -0.065));
  for (int i = 0; i < 2; ++i) {
    m->child->Reach(Side::kRight, screen.thing);
    m->child->Carry(Side::kRight, screen.hiding, 0.05);
    m->child->Wait(0.4);
    m->child->Reach(Side::kLeft, 0);
    Pose X = m->child->PoseOf(0);
    X.translation() += Vector3(i == 0 ? 0.1 : -0.1, 0.005, 0);
    m->child->Carry(Side::kLeft, X, 0, 0.9);
    m->child->Release(Side::kLeft);
    m->child->Wait(0.8);
    m->child->Carry(Side::kRight, screen.away, 0.05);
    m->child->Release(Side::kRight);
    m->child->Wait(1.5);
  }
}

/// The rest of the parts at the far side; a and b where they are told to be.
std::vector<Pose> Aside(const Making& m, int a, const Pose& X_a, int b, const Pose& X_b) {
  std::vector<Pose> poses;
  double x = -0.28;
  for (int i = 0; i < static_cast<int>(m.task.parts.size()); ++i) {
    if (i == a || i == b) {
      poses.push_back(i == a ? X_a : X_b);
      continue;
    }
    poses.push_back(Flat(m, i, x, 0.19, 1.4));
    x += 0.09;
  }
  return poses;
}

void PassOver(Making* m) {
  const auto [a, b] = EqualParts(m->task);
  m->Furnish({});
  m->Place(Aside(*m, a, Flat(*m, a, -0.16, -0.03, 1.2), b, Flat(*m, b, 0.02, -0.03, 1.4)));
  const double height =
      m->solids->Highest(b, m->child->PoseOf(b).linear()) - m->solids->Lowest(b, m->child->PoseOf(b).linear());
  double to = 0.2;
  for (int i = 0; i < 4; ++i) {
    m->child->Reach(Side::kRight, a);
    m->child->Carry(Side::kRight, Flat(*m, a, to, -0.03, 1.3), height + 0.008);
    m->child->Release(Side::kRight);
    m->child->Wait(0.8);
    to = -to;
  }
}

void Touching(Making* m) {
  const auto [a, b] = EqualParts(m->task);
  m->Furnish({});
  m->Place(Aside(*m, a, Flat(*m, a, -0.2, -0.05, 0.3), b, Flat(*m, b, 0.08, -0.03, 0.2)));
  const Pose away = m->child->PoseOf(a);
  const MeshExtent e = m->solids->extent(b);
  for (int i = 0; i < 3; ++i) {
    m->child->Reach(Side::kRight, a);
    Pose beside = m->child->PoseOf(b);
    // Side by side, then end to end.
    const Vector3 step =
        i % 2 == 0 ? Vector3(0, e.high.y() - e.low.y() + 0.0006, 0) : Vector3(-(e.high.x() - e.low.x()) - 0.0006, 0, 0);
    beside.translation() = beside * step;
    beside.translation().z() = m->child->PoseOf(b).translation().z();
    m->child->Carry(Side::kRight, beside, 0.05);
    m->child->Release(Side::kRight);
    m->child->Wait(1.5);
    m->child->Reach(Side::kRight, a);
    m->child->Carry(Side::kRight, away, 0.05);
    m->child->Release(Side::kRight);
    m->child->Wait(0.5);
  }
}

void Fast(Making* m) {
  m->Furnish({});
  m->Scatter(0.2);
  m->style.speed = 0.7;
  const Pose rest = m->child->PoseOf(0);
  for (int round = 0; round < 2; ++round) {
    const Side hand = m->child->NearerHand(m->child->PoseOf(0).translation());
    m->child->Reach(hand, 0);
    Pose up = m->child->PoseOf(0);
    up.translation().z() += 0.08;
    m->child->Carry(hand, up, 0);
    for (int i = 0; i < 4; ++i) {
      // A minimum-jerk movement's top speed is 1.875 times its average: here 1.2 m/s.
      const Vector3 goal(i % 2 == 0 ? 0.2 : -0.2, m->random.Uniform(-0.1, 0.05), m->random.Uniform(0.06, 0.14));
      const double way = (goal - m->child->PoseOf(0).translation()).norm();
      const Matrix3 turn =
          ExpRotation(Vector3(m->random.Uniform(-0.4, 0.4), m->random.Uniform(-0.4, 0.4), i % 2 == 0 ? 1.5 : -1.5));
      m->child->Carry(hand, MakePose(turn * m->child->PoseOf(0).linear(), goal), 0, 1.875 * way / 1.2);
      m->child->Wait(0.15);
    }
    m->child->Carry(hand, rest, 0);
    m->child->Release(hand);
    m->child->Wait(1.2);
  }
}

void LeaveAndReturn(Making* m) {
  m->Furnish({});
  m->Scatter(0.2);
  for (int round = 0; round < 2; ++round) {
    const Side hand = m->child->NearerHand(m->child->PoseOf(0).translation());
    const Pose lying = m->child->PoseOf(0);
    m->child->Reach(hand, 0);
    Pose up = lying;
    up.translation() = Vector3(hand == Side::kLeft ? 0.15 : -0.15, 0.35, 0.5);
    m->child->Carry(hand, up, 0);
    m->child->Wait(1.5);
    // Back on the other side of the table, turned.
    const double x = lying.translation().x() > 0 ? -0.06 - 0.05 * round : 0.06 + 0.05 * round;
    Pose back = MakePose(Eigen::AngleAxisd(1.1, Vector3::UnitZ()).toRotationMatrix() * lying.linear(),
                         Vector3(x, -0.26, lying.translation().z()));
    m->child->Carry(hand, back, 0);
    m->child->Release(hand);
    m->child->Wait(1.2);
  }
}

void HandedOver(Making* m) {
  m->Furnish({});
  m->Scatter(0.2);
  const int n = static_cast<int>(m->task.parts.size());
  for (int part = 0; part < std::min(n, 3); ++part) {
    const Pose lying = m->child->PoseOf(part);
    const Side first = m->child->NearerHand(lying.translation());
    m->child->Reach(first, part);
    Pose middle = lying;
    middle.translation() = Vector3(0, -0.02, 0.14);
    m->child->Carry(first, middle, 0);
    m->child->Reach(Other(first), part);
    m->scenario.performance.events.push_back(
        {.time = m->child->now(), .kind = "handed_over", .parts = {part}, .hand = ToString(Other(first))});
    m->child->Release(first);
    Pose down = lying;
    down.translation().x() = -lying.translation().x();
    down.translation().y() = -0.27;
    m->child->Carry(Other(first), down, 0);
    m->child->Release(Other(first));
    m->child->Wait(0.6);
  }
}

void HalfCovered(Making* m) {
  m->Furnish({});
  m->Scatter(0.3);
  for (int part = 0; part < static_cast<int>(m->task.parts.size()); ++part) {
    const Side hand = m->child->NearerHand(m->child->PoseOf(part).translation());
    m->child->Cover(hand, part, 1.6);
    m->child->Wait(0.4);
    m->child->Reach(hand, part);
    m->child->Wait(1.0);
    Pose nudge = m->child->PoseOf(part);
    nudge.translation() += Vector3(0.02, 0.015, 0);
    m->child->Carry(hand, nudge, 0);
    m->child->Release(hand);
    m->child->Wait(0.6);
  }
}

struct Entry {
  ScenarioName name;
  std::function<void(Making*)> make;
};

const std::vector<Entry>& Entries() {
  static const std::vector<Entry> entries{
      {{"assemble", "a lesson: the structure is built, with interludes, a mistake that is undone and a near miss"},
       Build},
      {{"ready", "the parts lie ready for a lesson, the child waits"}, Ready},
      {{"fig4", "parts lie still, the camera moves round an obstacle and is jolted (the paper's Fig. 4)"}, Fig4},
      {{"start", "all parts apart on the table, resting on any face; nobody there"}, Start},
      {{"hidden_still", "a part that lies still is fully hidden for 2 s"}, HiddenStill},
      {{"hidden_moving", "a part is moved 10 cm while it is fully hidden"}, HiddenMoving},
      {{"pass_over", "a part is carried close over an equal one, to and fro"}, PassOver},
      {{"touching", "a part is laid against an equal one, side by side and end to end"}, Touching},
      {{"fast", "a part is swung at 1.2 m/s and turned"}, Fast},
      {{"leave_return", "a part leaves the picture and comes back elsewhere"}, LeaveAndReturn},
      {{"handed_over", "parts go from hand to hand"}, HandedOver},
      {{"half_covered", "hands lie on parts and hold them"}, HalfCovered},
      {{"jolts", "a lesson before a camera on a shaky stand"}, BuildWithJolts},
      {{"shiny", "a lesson with parts whose depth is missing on 40 % of their area"}, BuildOfShinyParts},
      {{"dropped_frames",
        "a lesson at 30 Hz with every fifth frame missing, at times several in a row, and irregular time stamps"},
       Build},
      {{"slow_camera", "a lesson at 7 frames a second"}, Build},
      {{"noisy", "a lesson with twice the noise"}, BuildNoisy},
      {{"one_colour", "a lesson in which all parts have the colour of the first"}, BuildOfOneColour},
  };
  return entries;
}

/// Frames at a steady rate; dropped_frames: ids of a 120 Hz clock, frames late by up to 8 ms, some missing.
void SetFrameTimes(double seconds, Making* m) {
  Scenario& s = m->scenario;
  const bool irregular = s.options.name == "dropped_frames";
  if (s.options.name == "slow_camera") s.options.fps = 7;
  s.id_rate = irregular ? 120 : s.options.fps;
  const int frames = static_cast<int>(std::floor(seconds * (irregular ? 30 : s.options.fps)));
  int missing = 0;
  for (int i = 0; i < frames; ++i) {
    int id = i;
    if (irregular) {
      if (missing == 0 && i > 0 && m->random.Chance(0.15)) missing = m->random.Chance(0.2) ? 1 + m->random.Pick(8) : 1;
      id = 4 * i + (i > 0 ? m->random.Pick(2) : 0);
    }
    if (missing > 0) {
      --missing;
      continue;
    }
    s.image_ids.push_back(id);
    s.frame_times.push_back(id / s.id_rate);
  }
}

}  // namespace

const std::vector<ScenarioName>& ScenarioNames() {
  static const std::vector<ScenarioName> names = [] {
    std::vector<ScenarioName> all;
    for (const Entry& e : Entries()) all.push_back(e.name);
    return all;
  }();
  return names;
}

Scenario MakeScenario(const Task& task, const ScenarioOptions& options) {
  const auto& entries = Entries();
  const auto entry =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name.name == options.name; });
  if (entry == entries.end()) throw std::invalid_argument("scenario: no " + options.name + "; see --list");
  Making making(task, options);
  if (options.depth_sensor == "kinect") {
    making.scenario.stage.depth.kind = DepthSensorOptions::Kind::kStructuredLight;
  } else if (options.depth_sensor == "tof") {
    making.scenario.stage.depth.kind = DepthSensorOptions::Kind::kTimeOfFlight;
  } else if (options.depth_sensor == "perfect") {
    making.scenario.stage.depth.kind = DepthSensorOptions::Kind::kPerfect;
  } else {
    throw std::invalid_argument("depth sensor: found " + options.depth_sensor + ", expected kinect, tof or perfect");
  }
  entry->make(&making);
  SetFrameTimes(options.seconds > 0 ? options.seconds : making.child->now() + 1.0, &making);
  for (const Jolt& jolt : making.scenario.camera.jolts) {
    making.scenario.performance.events.push_back({.time = jolt.time,
                                                  .kind = "jolt",
                                                  .duration = jolt.duration,
                                                  .shift = jolt.shift.norm(),
                                                  .turn = jolt.turn.norm()});
  }
  return std::move(making.scenario);
}

}  // namespace coach
