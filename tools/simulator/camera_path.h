// How the simulated camera stands or moves.
#pragma once

#include <vector>

#include "common/geometry/pose.h"
#include "tools/simulator/random.h"

namespace coach {

/// A sudden push: the camera is shifted and turned within `duration` and drifts back within two seconds.
struct Jolt {
  double time = 0;                  ///< s
  double duration = 0.2;            ///< s
  Vector3 shift = Vector3::Zero();  ///< m, world
  Vector3 turn = Vector3::Zero();   ///< rad, camera frame
};

struct CameraPath {
  Vector3 target{0, 0.05, 0};  ///< m: what it looks at, world
  double distance = 1.03;      ///< m
  double azimuth = 0;          ///< rad about the table's normal, 0: facing the child
  double elevation = 0.78;     ///< rad above the table
  double roll = 0;             ///< rad
  double swing = 0;            ///< 0 still; 1: about +-35 degrees round the target and +-12 up and down
  double period = 11;          ///< s, of the swing
  double tremor = 0;           ///< m: amplitude of a hand-held camera's shaking
  double phase = 0;            ///< rad
  std::vector<Jolt> jolts;

  /// Pose of the camera in the world.
  Pose At(double time) const;
};

}  // namespace coach
