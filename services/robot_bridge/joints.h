// The joints of a NAO V5/V6 that Coach moves: names, limits, speeds. Every back end speaks in these.
#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace coach {

enum class Joint {
  kHeadYaw,
  kHeadPitch,
  kLShoulderPitch,
  kLShoulderRoll,
  kLElbowYaw,
  kLElbowRoll,
  kLWristYaw,
  kRShoulderPitch,
  kRShoulderRoll,
  kRElbowYaw,
  kRElbowRoll,
  kRWristYaw,
};
constexpr int kNumJoints = 12;

enum class Arm { kLeft, kRight };
inline Arm Other(Arm arm) { return arm == Arm::kLeft ? Arm::kRight : Arm::kLeft; }

/// The five joints of an arm start here: ShoulderPitch, ShoulderRoll, ElbowYaw, ElbowRoll, WristYaw.
inline int FirstJoint(Arm arm) {
  return static_cast<int>(arm == Arm::kLeft ? Joint::kLShoulderPitch : Joint::kRShoulderPitch);
}

struct JointLimit {
  std::string_view name;  ///< as ALMotion calls it
  double low, high;       ///< rad
  double speed;           ///< rad/s, at most
};
const JointLimit& LimitOf(int joint);
inline const JointLimit& LimitOf(Joint joint) { return LimitOf(static_cast<int>(joint)); }

/// Angles (rad), indexed by Joint.
using JointAngles = std::array<double, kNumJoints>;

inline double& At(JointAngles& angles, Joint joint) { return angles[static_cast<size_t>(joint)]; }
inline double At(const JointAngles& angles, Joint joint) { return angles[static_cast<size_t>(joint)]; }

/// Head pitch allowed at a head yaw: the head would touch the shoulders beyond (Aldebaran's table, linear between).
struct PitchRange {
  double low, high;  ///< rad
};
PitchRange HeadPitchRange(double yaw);

/// Angles brought inside the limits of every joint, head pitch by the yaw.
JointAngles ClampToLimits(const JointAngles& angles);
/// Every angle is finite and within the limits (1e-9).
bool WithinLimits(const JointAngles& angles);

/// Head straight, arms at rest on the thighs of the seated robot.
const JointAngles& RestAngles();

/// Joint angles over time; the robot's joints follow straight lines between the points.
struct JointPath {
  struct Point {
    double time;  ///< s from the start, growing; the first point is at 0, where the robot is
    JointAngles angles;
  };
  std::vector<Point> points;
  std::array<bool, kNumJoints> moves{};  ///< joints that the path concerns; others are left alone

  double duration() const { return points.empty() ? 0 : points.back().time; }
  /// Angles at a time, held before the start and after the end. The path must not be empty.
  JointAngles At(double time) const;
};

/// A smooth path through way-points (the first is where the robot is): starts and ends at rest, no joint ever faster
/// than `speed_fraction` of its limit, sampled every 0.05 s. Joints that do not move are not in `moves`.
JointPath SmoothPath(const std::vector<JointAngles>& way_points, double speed_fraction);

}  // namespace coach
