// Where the robot sits: its pose in the table's frame, from a part that it holds in its hand in several poses of the
// arm while the tracker sees the part.
#pragma once

#include <string>
#include <vector>

#include "common/geometry/pose.h"
#include "services/robot_bridge/joints.h"

namespace coach {

struct CalibrationSample {
  Arm arm = Arm::kRight;
  JointAngles angles{};           ///< measured
  Vector3 p_T = Vector3::Zero();  ///< m, the part's origin as tracked
};

struct CalibrationResult {
  bool success = false;
  std::string problem;            ///< why not
  Pose X_TR = Pose::Identity();   ///< the robot's torso in the table frame
  Vector3 p_H = Vector3::Zero();  ///< m, the part's origin in the hand's frame: it need not be held by its middle
  double residual = 0;            ///< m, root mean square distance between the samples and the fit
  double left_out_residual = 0;   ///< m, the same for each sample by the fit to the others: what to expect at the table
};

/// Least squares: Kabsch's rotation and shift for a given p_H, a linear system for p_H, in turn until both rest. The
/// part's place in the hand is taken as at most 6 cm from the hand's point.
/// Needs 6 samples or more that do not lie in one plane (4 mm).
CalibrationResult CalibrateRobot(const std::vector<CalibrationSample>& samples);

/// Eight poses of an arm, spread wide, the hand turned this way and that, all high above the robot's lap.
std::vector<JointAngles> CalibrationPoses(Arm arm);

}  // namespace coach
