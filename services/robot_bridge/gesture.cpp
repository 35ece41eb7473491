#include "services/robot_bridge/gesture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace coach {
namespace {

constexpr double kPitchStep = 0.02;         // rad, by which an aim is raised until it clears the table
constexpr double kHeightTolerance = 0.005;  // m

double DistanceToSegment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 ab = b - a;
  const double share = std::clamp((p - a).dot(ab) / std::max(ab.squaredNorm(), 1e-12), 0.0, 1.0);
  return (p - a - share * ab).norm();
}

struct ArmExtent {
  double lowest, farthest;  // m, z_T of the lowest and x_R of the most advanced of elbow, wrist, hand
};

ArmExtent ExtentOf(Arm arm, const JointAngles& angles, const Pose& X_TR) {
  const ArmPoints points = ForwardKinematics(arm, angles);
  ArmExtent extent{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const Vector3* p_R : {&points.p_R_elbow, &points.p_R_wrist, &points.p_R_hand}) {
    extent.lowest = std::min(extent.lowest, (X_TR * *p_R).z());
    extent.farthest = std::max(extent.farthest, p_R->x());
  }
  return extent;
}

JointAngles WithArm(const JointAngles& base, Arm arm, const JointAngles& arm_from) {
  JointAngles result = base;
  const auto first = static_cast<size_t>(FirstJoint(arm));
  for (size_t j = first; j < first + 5; ++j) result[j] = arm_from[j];
  return result;
}

/// The arm folded high before the chest: between it and any pointing pose the hand stays up.
JointAngles Folded(const JointAngles& from, Arm arm) {
  const double side = arm == Arm::kLeft ? 1 : -1;
  JointAngles angles = from;
  const auto first = static_cast<size_t>(FirstJoint(arm));
  angles[first] = 0.3;
  angles[first + 1] = side * 0.25;
  angles[first + 2] = -side * 1.4;
  angles[first + 3] = -side * 1.5;
  angles[first + 4] = 0;
  return angles;
}

/// The first way to the goal on which nothing is met.
PointingPlan PlanWay(Arm arm, const JointAngles& from, const JointAngles& goal, const Surroundings& surroundings,
                     const GestureOptions& options) {
  PointingPlan plan;
  plan.arm = arm;
  const std::vector<std::vector<JointAngles>> ways{{from, goal}, {from, Folded(from, arm), goal}};
  for (const auto& way : ways) {
    const JointPath path = SmoothPath(way, options.speed_fraction);
    const Obstacle obstacle = FirstObstacle(arm, path, 0, surroundings, options);
    if (obstacle == Obstacle::kNone) {
      plan.possible = true;
      plan.obstacle = Obstacle::kNone;
      plan.path = path;
      return plan;
    }
    if (plan.obstacle == Obstacle::kNone) plan.obstacle = obstacle;
  }
  return plan;
}

Aim AimAbove(Arm arm, const Vector3& p_R, const JointAngles& from, const Surroundings& surroundings,
             const GestureOptions& options) {
  Aim aim = PointAt(arm, from, p_R);
  double& pitch = aim.angles[static_cast<size_t>(FirstJoint(arm))];
  while (ExtentOf(arm, aim.angles, surroundings.X_TR).lowest < options.table_margin && pitch > -0.5) {
    pitch -= kPitchStep;
    aim.clamped = true;
  }
  aim.residual = PointingError(arm, aim.angles, p_R);
  return aim;
}

}  // namespace

Arm ChooseArm(const Vector3& p_R, Arm last, double hysteresis) {
  if (p_R.y() > hysteresis) return Arm::kLeft;
  if (p_R.y() < -hysteresis) return Arm::kRight;
  return last;
}

double Clearance(Arm arm, const JointAngles& angles, const Pose& X_TR, const ForeignBlob& blob) {
  const ArmPoints points = ForwardKinematics(arm, angles);
  const Vector3 p_R = X_TR.inverse() * blob.centre;
  return std::min(DistanceToSegment(p_R, points.p_R_shoulder, points.p_R_elbow),
                  DistanceToSegment(p_R, points.p_R_elbow, points.p_R_hand)) -
         blob.radius;
}

Obstacle FirstObstacle(Arm arm, const JointPath& path, double from_s, const Surroundings& surroundings,
                       const GestureOptions& options) {
  if (path.points.empty()) return Obstacle::kNone;
  const Pose& X_TR = surroundings.X_TR;
  const ArmExtent start = ExtentOf(arm, path.points.front().angles, X_TR);
  const ArmExtent goal = ExtentOf(arm, path.points.back().angles, X_TR);
  const double floor = std::min({options.table_margin, start.lowest, goal.lowest}) - kHeightTolerance;
  const double farthest = std::max(options.child_distance, start.farthest);
  for (const JointPath::Point& point : path.points) {
    if (point.time < from_s) continue;
    const ArmExtent extent = ExtentOf(arm, point.angles, X_TR);
    if (extent.lowest < floor) return Obstacle::kTable;
    if (extent.farthest > farthest) return Obstacle::kChild;
    for (const ForeignBlob& blob : surroundings.hands) {
      if (Clearance(arm, point.angles, X_TR, blob) < options.hand_clearance) return Obstacle::kHand;
    }
  }
  return Obstacle::kNone;
}

PointingPlan PlanPointing(const Vector3& p_T, const JointAngles& from, Arm last_arm, const Surroundings& surroundings,
                          const GestureOptions& options) {
  const Vector3 p_R = surroundings.X_TR.inverse() * p_T;
  Arm arm = ChooseArm(p_R, last_arm, options.arm_hysteresis);
  Aim aim = AimAbove(arm, p_R, from, surroundings, options);
  const Aim other = AimAbove(Other(arm), p_R, from, surroundings, options);
  if (aim.clamped && other.residual + 0.05 < aim.residual) {
    arm = Other(arm);
    aim = other;
  }
  PointingPlan plan;
  plan.arm = arm;
  if (p_R.x() > 0 && aim.residual <= options.largest_residual) {
    plan = PlanWay(arm, from, aim.angles, surroundings, options);
  }
  plan.clamped = aim.clamped || !plan.possible;
  plan.residual = aim.residual;
  return plan;
}

PointingPlan PlanArmDown(Arm arm, const JointAngles& from, const Surroundings& surroundings,
                         const GestureOptions& options) {
  return PlanWay(arm, from, WithArm(from, arm, RestAngles()), surroundings, options);
}

GazePlan PlanGaze(const Vector3& p_T, const JointAngles& from, const Surroundings& surroundings,
                  const GestureOptions& options) {
  const Aim aim = LookAt(from, surroundings.X_TR.inverse() * p_T);
  return {SmoothPath({from, aim.angles}, options.speed_fraction), aim.clamped, aim.residual};
}

GazePlan PlanHeadStraight(const JointAngles& from, const GestureOptions& options) {
  JointAngles goal = from;
  At(goal, Joint::kHeadYaw) = At(goal, Joint::kHeadPitch) = 0;
  return {SmoothPath({from, goal}, options.speed_fraction), false, 0};
}

}  // namespace coach
