// Where a NAO's arms and head are, and which angles point an arm or the gaze at a target. All in the torso's frame R:
// x front, y left, z up, metres. Lengths: NAO V5/V6 (Aldebaran's documentation of links and joints).
#pragma once

#include "common/geometry/pose.h"
#include "services/robot_bridge/joints.h"

namespace coach {

struct ArmPoints {
  Vector3 p_R_shoulder, p_R_elbow, p_R_wrist, p_R_hand;
  Vector3 forearm;  ///< unit, from the elbow to the wrist
};
ArmPoints ForwardKinematics(Arm arm, const JointAngles& angles);

/// Pose of the hand's frame in the torso; its x axis is the forearm's line, WristYaw turns it about that line.
Pose HandPose(Arm arm, const JointAngles& angles);

struct Gaze {
  Vector3 p_R_camera;
  Vector3 direction;  ///< unit, the top camera's axis
};
Gaze GazeOf(const JointAngles& angles);

/// What an aim came to. `clamped`: a limit binds, and `residual` is the angle (rad) between the line that was wanted
/// and the line that is had.
struct Aim {
  JointAngles angles{};
  bool clamped = false;
  double residual = 0;
};

/// Turns the head so that the top camera's axis goes through the target; other joints are kept. Closed form.
Aim LookAt(const JointAngles& from, const Vector3& p_R);

/// Straightens the arm (ElbowRoll at its limit, ElbowYaw and WristYaw 0) and turns the shoulder so that the forearm's
/// line goes through the target; other joints are kept. Closed form: the elbow's offset is exact, so inside the limits
/// the residual is rounding.
Aim PointAt(Arm arm, const JointAngles& from, const Vector3& p_R);

/// Angle (rad) between the forearm's line and the line from the elbow to the target.
double PointingError(Arm arm, const JointAngles& angles, const Vector3& p_R);
/// Angle (rad) between the camera's axis and the line from the camera to the target.
double GazeError(const JointAngles& angles, const Vector3& p_R);

}  // namespace coach
