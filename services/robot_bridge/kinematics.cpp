#include "services/robot_bridge/kinematics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace coach {
namespace {

constexpr double kNeckHeight = 0.1265;
constexpr double kShoulderSide = 0.098, kShoulderHeight = 0.100;
constexpr double kUpperArm = 0.105, kElbowSide = 0.015;
constexpr double kForearm = 0.05595, kHand = 0.05775, kHandHeight = 0.01231;
constexpr double kCameraFront = 0.05871, kCameraHeight = 0.06364;
constexpr double kCameraTilt = 1.2 * std::numbers::pi / 180;

double Side(Arm arm) { return arm == Arm::kLeft ? 1 : -1; }

Matrix3 Rx(double angle) { return Eigen::AngleAxisd(angle, Vector3::UnitX()).toRotationMatrix(); }
Matrix3 Ry(double angle) { return Eigen::AngleAxisd(angle, Vector3::UnitY()).toRotationMatrix(); }
Matrix3 Rz(double angle) { return Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix(); }

double AngleBetween(const Vector3& a, const Vector3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

struct ArmFrames {
  Vector3 p_R_shoulder;
  Matrix3 upper_arm, forearm;  // orientations in R
};

ArmFrames FramesOf(Arm arm, const JointAngles& angles) {
  const auto first = static_cast<size_t>(FirstJoint(arm));
  const Matrix3 upper_arm = Ry(angles[first]) * Rz(angles[first + 1]);
  return {Vector3(0, Side(arm) * kShoulderSide, kShoulderHeight), upper_arm,
          upper_arm * Rx(angles[first + 2]) * Rz(angles[first + 3])};
}

Vector3 ElbowOf(Arm arm, const ArmFrames& frames) {
  return frames.p_R_shoulder + frames.upper_arm * Vector3(kUpperArm, Side(arm) * kElbowSide, 0);
}

}  // namespace

ArmPoints ForwardKinematics(Arm arm, const JointAngles& angles) {
  const ArmFrames frames = FramesOf(arm, angles);
  const Vector3 elbow = ElbowOf(arm, frames);
  const Vector3 forearm = frames.forearm.col(0);
  return {frames.p_R_shoulder, elbow, elbow + kForearm * forearm, HandPose(arm, angles).translation(), forearm};
}

Pose HandPose(Arm arm, const JointAngles& angles) {
  const ArmFrames frames = FramesOf(arm, angles);
  Pose X_RH = Pose::Identity();
  const double wrist_yaw = angles[static_cast<size_t>(FirstJoint(arm)) + 4];
  X_RH.linear() = frames.forearm * Rx(wrist_yaw);
  X_RH.translation() =
      ElbowOf(arm, frames) + kForearm * frames.forearm.col(0) + X_RH.linear() * Vector3(kHand, 0, -kHandHeight);
  return X_RH;
}

Gaze GazeOf(const JointAngles& angles) {
  const Matrix3 head = Rz(At(angles, Joint::kHeadYaw)) * Ry(At(angles, Joint::kHeadPitch));
  return {Vector3(0, 0, kNeckHeight) + head * Vector3(kCameraFront, 0, kCameraHeight),
          head * Ry(kCameraTilt) * Vector3::UnitX()};
}

Aim LookAt(const JointAngles& from, const Vector3& p_R) {
  // In the vertical plane through neck and target the camera's line passes the neck at a fixed distance h, so
  // reach * sin(down + elevation) = h.
  const double h = kCameraFront * std::sin(kCameraTilt) + kCameraHeight * std::cos(kCameraTilt);
  const double ahead = std::hypot(p_R.x(), p_R.y()), up = p_R.z() - kNeckHeight;
  const double reach = std::max(std::hypot(ahead, up), h);
  Aim aim;
  aim.angles = from;
  At(aim.angles, Joint::kHeadYaw) = std::atan2(p_R.y(), p_R.x());
  At(aim.angles, Joint::kHeadPitch) = std::asin(h / reach) - std::atan2(up, ahead) - kCameraTilt;
  const JointAngles wanted = aim.angles;
  aim.angles = ClampToLimits(aim.angles);
  aim.clamped = std::abs(At(wanted, Joint::kHeadYaw) - At(aim.angles, Joint::kHeadYaw)) > 1e-9 ||
                std::abs(At(wanted, Joint::kHeadPitch) - At(aim.angles, Joint::kHeadPitch)) > 1e-9;
  aim.residual = GazeError(aim.angles, p_R);
  return aim;
}

Aim PointAt(Arm arm, const JointAngles& from, const Vector3& p_R) {
  Aim aim;
  aim.angles = from;
  const auto first = static_cast<size_t>(FirstJoint(arm));
  const double elbow_roll = -Side(arm) * 0.0349;  // as straight as the elbow goes
  const Vector3 t = p_R - Vector3(0, Side(arm) * kShoulderSide, kShoulderHeight);

  // In the upper arm's frame the forearm's line is e + lambda d in the plane z = 0. The target is the point of it at
  // the distance |t| from the shoulder; beta is its bearing there.
  const Eigen::Vector2d e(kUpperArm, Side(arm) * kElbowSide), d(std::cos(elbow_roll), std::sin(elbow_roll));
  const double reach = std::max(t.norm(), e.norm() + 1e-6);
  const double along = e.dot(d);
  const double lambda = -along + std::sqrt(along * along + reach * reach - e.squaredNorm());
  const Eigen::Vector2d q = e + lambda * d;
  const double beta = std::atan2(q.y(), q.x());
  aim.angles[first] = std::atan2(-t.z(), t.x());
  aim.angles[first + 1] = std::asin(std::clamp(t.y() / reach, -1.0, 1.0)) - beta;
  aim.angles[first + 2] = 0;
  aim.angles[first + 3] = elbow_roll;
  aim.angles[first + 4] = 0;

  const JointAngles wanted = aim.angles;
  aim.angles = ClampToLimits(aim.angles);
  for (size_t j = first; j < first + 5; ++j) aim.clamped |= std::abs(wanted[j] - aim.angles[j]) > 1e-9;
  aim.clamped |= t.norm() <= e.norm();
  aim.residual = PointingError(arm, aim.angles, p_R);
  return aim;
}

double PointingError(Arm arm, const JointAngles& angles, const Vector3& p_R) {
  const ArmPoints points = ForwardKinematics(arm, angles);
  return AngleBetween(points.forearm, p_R - points.p_R_elbow);
}

double GazeError(const JointAngles& angles, const Vector3& p_R) {
  const Gaze gaze = GazeOf(angles);
  return AngleBetween(gaze.direction, p_R - gaze.p_R_camera);
}

}  // namespace coach
