// How parts move when nobody looks: damped velocity with white noise.
// [Wuethrich et al. 2013], generalised to the true time between frames.
#pragma once

#include "common/geometry/pose.h"
#include "services/pose_filter/random.h"

namespace coach {

/// Per step of 1/30 s.
struct ProcessOptions {
  double damping = 0.8;            ///< share of the velocity that stays
  double position_noise = 0.0025;  ///< m, each axis
  double rotation_noise = 0.02;    ///< rad, each axis
  double longest_gap = 2;          ///< s; a longer time between frames counts as this
};

/// Pose of a part relative to a base pose, Perturb(base, q), and its rate per 1/30 s.
struct MotionState {
  Vector6 q = Vector6::Zero();  ///< m, rad; parent frame
  Vector6 v = Vector6::Zero();  ///< m, rad per 1/30 s
};

/// Moves a state on by dt seconds. tau = 30 dt is walked in steps rho <= 1:
/// v' = 0.8^rho v + sqrt(rho) Sigma n, q' = q + rho 0.8^rho v + sqrt(rho) Sigma n with the same n ~ N(0, I).
void Propagate(const ProcessOptions& options, double dt, Random& random, MotionState& state);

}  // namespace coach
