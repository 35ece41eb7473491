// Plans of gestures: which arm points, by which way it gets there, and what must not be touched on the way.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/assembly/part_poses.h"
#include "services/robot_bridge/joints.h"
#include "services/robot_bridge/kinematics.h"

namespace coach {

struct GestureOptions {
  double speed_fraction = 0.3;    ///< of each joint's limit, at most 0.3
  double hold_s = 3;              ///< s, the longest time that an arm is held up
  double table_margin = 0.02;     ///< m, least height of elbow, wrist and hand above the table
  double hand_clearance = 0.15;   ///< m, least distance from the surface of a foreign blob to the arm
  double arm_hysteresis = 0.03;   ///< m, how far across the middle a target must be to change the arm
  double child_distance = 0.75;   ///< m ahead of the torso, no arm goes farther: there the child sits
  double largest_residual = 0.5;  ///< rad, an arm that would miss by more than this is not raised
};

/// What is around the robot.
struct Surroundings {
  Pose X_TR = Pose::Identity();
  std::vector<ForeignBlob> hands;  ///< table frame
};

/// The target's side; inside the hysteresis band the arm used last.
Arm ChooseArm(const Vector3& p_R, Arm last, double hysteresis);

/// Why the arm's points may not follow the path from a time on; empty: they may. Heights are compared with the table's
/// margin, or with the lower end of the path where that is lower still.
enum class Obstacle { kNone, kTable, kHand, kChild };
Obstacle FirstObstacle(Arm arm, const JointPath& path, double from_s, const Surroundings& surroundings,
                       const GestureOptions& options);

/// Least distance (m) from the upper arm or the forearm with the hand to the surface of a blob.
double Clearance(Arm arm, const JointAngles& angles, const Pose& X_TR, const ForeignBlob& blob);

struct PointingPlan {
  bool possible = false;
  Obstacle obstacle = Obstacle::kNone;  ///< why not: what is in the way (a hand may go away); kNone: out of reach
  Arm arm = Arm::kRight;
  JointPath path;
  bool clamped = false;  ///< the arm points as near to the target as it may
  double residual = 0;   ///< rad
};

/// Raises an arm towards the target (table frame): straight there, or by way of the folded arm where something is in
/// the way. An arm that would come too near to the table points higher, and says so by `clamped`.
PointingPlan PlanPointing(const Vector3& p_T, const JointAngles& from, Arm last_arm, const Surroundings& surroundings,
                          const GestureOptions& options);

/// Takes an arm to its rest. `obstacle` tells what is in the way of all ways known.
PointingPlan PlanArmDown(Arm arm, const JointAngles& from, const Surroundings& surroundings,
                         const GestureOptions& options);

struct GazePlan {
  JointPath path;
  bool clamped = false;
  double residual = 0;  ///< rad
};
GazePlan PlanGaze(const Vector3& p_T, const JointAngles& from, const Surroundings& surroundings,
                  const GestureOptions& options);
/// The head straight again.
GazePlan PlanHeadStraight(const JointAngles& from, const GestureOptions& options);

}  // namespace coach
