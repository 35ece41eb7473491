// The room of a simulated lesson: table, background, clutter, light, looks. World frame: origin in the middle of the
// table's top, z up, x to the right and y away from the camera, which faces the child.
#pragma once

#include <string>
#include <vector>

#include "common/assembly/task.h"
#include "tools/simulator/body.h"
#include "tools/simulator/random.h"
#include "tools/simulator/shading.h"

namespace coach {

struct RoomOptions {
  int clutter = 4;             ///< things on the table that are no part
  double clutter_from = 0.36;  ///< m: they lie at least this far from the middle, across or along
  double light = 1;            ///< factor on all light
};

struct Fixture {
  TriangleMesh mesh;
  Material material;
  Pose X_W = Pose::Identity();
};

/// A round place on the table, m.
struct Spot {
  Eigen::Vector2d centre{0, 0};
  double radius = 0;
};

struct Room {
  std::vector<Pattern> patterns;
  std::vector<Fixture> fixtures;
  Lighting lighting;
  Material skin, clothes, hair;
  BodyShape body;
  std::vector<Spot> clutter;  ///< where things lie that are no part
};

Room MakeRoom(const RoomOptions& options, Random& random);

/// The look of a part whose colour range is given: the middle of the range under the room's light.
Material PartMaterial(const HsvRange& range);

/// Half the size of the table's top, m.
inline constexpr double kTableHalfX = 0.62, kTableHalfY = 0.42;

}  // namespace coach
