#include "services/robot_bridge/joints.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coach {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kSampleTime = 0.05;  // s

constexpr std::array<JointLimit, kNumJoints> kLimits{{
    {"HeadYaw", -2.0857, 2.0857, 8.27},
    {"HeadPitch", -0.6720, 0.5149, 7.19},
    {"LShoulderPitch", -2.0857, 2.0857, 8.27},
    {"LShoulderRoll", -0.3142, 1.3265, 7.19},
    {"LElbowYaw", -2.0857, 2.0857, 8.27},
    {"LElbowRoll", -1.5446, -0.0349, 7.19},
    {"LWristYaw", -1.8238, 1.8238, 24.6},
    {"RShoulderPitch", -2.0857, 2.0857, 8.27},
    {"RShoulderRoll", -1.3265, 0.3142, 7.19},
    {"RElbowYaw", -2.0857, 2.0857, 8.27},
    {"RElbowRoll", 0.0349, 1.5446, 7.19},
    {"RWristYaw", -1.8238, 1.8238, 24.6},
}};

struct PitchRow {
  double yaw, low, high;  // degrees
};
constexpr std::array<PitchRow, 7> kPitchRows{{{0, -38.5, 29.51},
                                              {27.85, -38.5, 24.18},
                                              {43.32, -31.4, 21.2},
                                              {51.74, -27.5, 18.91},
                                              {62.45, -24.64, 17.19},
                                              {87.49, -18.91, 11.46},
                                              {119.52, -25.73, 18.91}}};

}  // namespace

const JointLimit& LimitOf(int joint) { return kLimits[static_cast<size_t>(joint)]; }

PitchRange HeadPitchRange(double yaw) {
  const double degrees = std::abs(yaw) / kDegree;
  for (size_t i = 1; i < kPitchRows.size(); ++i) {
    const PitchRow &a = kPitchRows[i - 1], &b = kPitchRows[i];
    if (degrees > b.yaw) continue;
    const double share = (degrees - a.yaw) / (b.yaw - a.yaw);
    return {(a.low + share * (b.low - a.low)) * kDegree, (a.high + share * (b.high - a.high)) * kDegree};
  }
  return {kPitchRows.back().low * kDegree, kPitchRows.back().high * kDegree};
}

JointAngles ClampToLimits(const JointAngles& angles) {
  JointAngles result = angles;
  for (int j = 0; j < kNumJoints; ++j) {
    double& angle = result[static_cast<size_t>(j)];
    angle = std::clamp(angle, LimitOf(j).low, LimitOf(j).high);
  }
  const PitchRange pitch = HeadPitchRange(At(result, Joint::kHeadYaw));
  double& head = At(result, Joint::kHeadPitch);
  head = std::clamp(head, pitch.low, pitch.high);
  return result;
}

bool WithinLimits(const JointAngles& angles) {
  const JointAngles clamped = ClampToLimits(angles);
  for (size_t j = 0; j < angles.size(); ++j) {
    if (!(std::abs(angles[j] - clamped[j]) <= 1e-9)) return false;
  }
  return true;
}

const JointAngles& RestAngles() {
  static const JointAngles kRest{0, 0, 0.92, 0.28, -0.43, -1.2, 0, 0.92, -0.28, 0.43, 1.2, 0};
  return kRest;
}

JointAngles JointPath::At(double time) const {
  if (time <= points.front().time) return points.front().angles;
  for (size_t i = 1; i < points.size(); ++i) {
    const Point &a = points[i - 1], &b = points[i];
    if (time > b.time) continue;
    const double share = (time - a.time) / (b.time - a.time);
    JointAngles angles{};
    for (size_t j = 0; j < angles.size(); ++j) angles[j] = a.angles[j] + share * (b.angles[j] - a.angles[j]);
    return angles;
  }
  return points.back().angles;
}

JointPath SmoothPath(const std::vector<JointAngles>& way_points, double speed_fraction) {
  JointPath path;
  path.points.push_back({0, way_points.front()});
  std::vector<double> reached{0};  // s at full allowed speed
  for (size_t i = 1; i < way_points.size(); ++i) {
    double needed = 0;
    for (int j = 0; j < kNumJoints; ++j) {
      const double change = std::abs(way_points[i][static_cast<size_t>(j)] - way_points[i - 1][static_cast<size_t>(j)]);
      if (change > 1e-6) path.moves[static_cast<size_t>(j)] = true;
      needed = std::max(needed, change / (LimitOf(j).speed * speed_fraction));
    }
    reached.push_back(reached.back() + needed);
  }
  const double length = reached.back();
  if (length <= 0) return path;

  // s(t) = 3 t^2 - 2 t^3 has a peak slope of 1.5: the whole takes 1.5 times as long as at full allowed speed.
  const double duration = 1.5 * length;
  const int samples = std::max(2, static_cast<int>(std::ceil(duration / kSampleTime)));
  size_t segment = 1;
  for (int i = 1; i <= samples; ++i) {
    const double u = static_cast<double>(i) / samples;
    const double along = length * u * u * (3 - 2 * u);
    while (segment + 1 < reached.size() && along > reached[segment]) ++segment;
    const double span = reached[segment] - reached[segment - 1];
    const double share = span > 0 ? (along - reached[segment - 1]) / span : 1;
    JointAngles angles{};
    for (size_t j = 0; j < angles.size(); ++j) {
      angles[j] = way_points[segment - 1][j] + share * (way_points[segment][j] - way_points[segment - 1][j]);
    }
    // The head's pitch limit is not convex in its yaw: a straight line between two allowed poses may leave it.
    path.points.push_back({u * duration, ClampToLimits(angles)});
  }
  path.points.back().angles = way_points.back();
  return path;
}

}  // namespace coach
