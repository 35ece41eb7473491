// What a scenario is made of while it is being made, and the steps that all scenarios share.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "tools/simulator/random.h"
#include "tools/simulator/room.h"
#include "tools/simulator/scenario.h"
#include "tools/simulator/solids.h"
#include "tools/simulator/structure.h"

namespace coach {

struct Making {
  /// The task's parts with their materials and ids; nothing is anywhere yet.
  Making(const Task& t, const ScenarioOptions& options);
  Making(const Making&) = delete;
  Making& operator=(const Making&) = delete;

  /// A thing beside the parts; before Furnish.
  void AddProp(const TriangleMesh& mesh, const Pose& X_W);
  /// Room, camera and sensors; once, after the props.
  void Furnish(const RoomOptions& room);
  /// The parts at their places, the props at theirs, and the child with its hands at home.
  void Place(std::vector<Pose> parts);
  /// Scattered parts; nothing is going to be built. @param any_face chance that a part rests on another face
  void Scatter(double any_face);

  Scenario scenario;
  Task& task;  ///< the scenario's
  Random random;
  ChildStyle style;
  Structure structure;
  CameraModel camera;
  std::vector<Pose> props_at;
  std::unique_ptr<Solids> solids;  ///< from Furnish on
  std::unique_ptr<Child> child;    ///< from Place on
};

/// A part that lies as in the structure, with its own x along the yaw (rad).
Pose Flat(const Making& m, int part, double x, double y, double yaw);

/// The first part of its kind that has an equal, and that equal.
/// @throws std::invalid_argument if there are no two
std::pair<int, int> EqualParts(const Task& task);

}  // namespace coach
