#include "services/robot_bridge/robot_calibration.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "services/robot_bridge/kinematics.h"

namespace coach {
namespace {

constexpr size_t kFewestSamples = 6;
constexpr double kFlat = 0.004;         // m, root mean square extent in the thinnest direction
constexpr double kFarthestHold = 0.06;  // m
constexpr int kRounds = 2000;

Matrix3 SpreadOf(const std::vector<Vector3>& points, const Vector3& mean) {
  Matrix3 spread = Matrix3::Zero();
  for (const Vector3& p : points) spread += (p - mean) * (p - mean).transpose();
  return spread / static_cast<double>(points.size());
}

Vector3 MeanOf(const std::vector<Vector3>& points) {
  Vector3 mean = Vector3::Zero();
  for (const Vector3& p : points) mean += p;
  return mean / static_cast<double>(points.size());
}

/// The rigid motion that brings `from` nearest to `to` (Kabsch 1976).
Pose Kabsch(const std::vector<Vector3>& from, const std::vector<Vector3>& to) {
  const Vector3 mean_from = MeanOf(from), mean_to = MeanOf(to);
  Matrix3 correlation = Matrix3::Zero();
  for (size_t i = 0; i < from.size(); ++i) correlation += (to[i] - mean_to) * (from[i] - mean_from).transpose();
  const Eigen::JacobiSVD<Matrix3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 reflection = Matrix3::Identity();
  reflection(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Matrix3 R = svd.matrixU() * reflection * svd.matrixV().transpose();
  return MakePose(R, mean_to - R * mean_from);
}

struct Fit {
  Pose X_TR = Pose::Identity();
  Vector3 p_H = Vector3::Zero();
};

Fit FitTo(const std::vector<Pose>& hands, const std::vector<Vector3>& seen) {
  Fit fit;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Vector3> held;
    for (const Pose& X_RH : hands) held.push_back(X_RH * fit.p_H);
    fit.X_TR = Kabsch(held, seen);
    // p_T = X_TR (p_RH + R_RH p_H): linear in p_H, and R_TR R_RH is a rotation, so the normal matrix is n times one.
    Vector3 sum = Vector3::Zero();
    for (size_t i = 0; i < hands.size(); ++i) {
      sum += hands[i].linear().transpose() * (fit.X_TR.inverse() * seen[i] - hands[i].translation());
    }
    const Vector3 next = sum / static_cast<double>(hands.size());
    const double change = (next - fit.p_H).norm();
    fit.p_H = next;
    if (change < 1e-9) break;
  }
  return fit;
}

double SquaredError(const Fit& fit, const Pose& X_RH, const Vector3& p_T) {
  return (fit.X_TR * (X_RH * fit.p_H) - p_T).squaredNorm();
}

double LeftOut(const std::vector<Pose>& hands, const std::vector<Vector3>& seen) {
  double sum = 0;
  for (size_t out = 0; out < hands.size(); ++out) {
    std::vector<Pose> some_hands = hands;
    std::vector<Vector3> some_seen = seen;
    some_hands.erase(some_hands.begin() + static_cast<std::ptrdiff_t>(out));
    some_seen.erase(some_seen.begin() + static_cast<std::ptrdiff_t>(out));
    sum += SquaredError(FitTo(some_hands, some_seen), hands[out], seen[out]);
  }
  return std::sqrt(sum / static_cast<double>(hands.size()));
}

}  // namespace

CalibrationResult CalibrateRobot(const std::vector<CalibrationSample>& samples) {
  CalibrationResult result;
  if (samples.size() < kFewestSamples) {
    result.problem = "only " + std::to_string(samples.size()) + " samples, at least 6 are needed";
    return result;
  }
  std::vector<Pose> hands;
  std::vector<Vector3> seen;
  for (const CalibrationSample& sample : samples) {
    if (!sample.p_T.allFinite() || !WithinLimits(ClampToLimits(sample.angles))) {
      result.problem = "a sample with numbers that are not finite";
      return result;
    }
    hands.push_back(HandPose(sample.arm, sample.angles));
    seen.push_back(sample.p_T);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3> extent(SpreadOf(seen, MeanOf(seen)));
  if (extent.eigenvalues()(0) < kFlat * kFlat) {
    result.problem = "the samples lie in one plane or line: the arm must take poses that are spread out";
    return result;
  }
  const Fit fit = FitTo(hands, seen);
  result.X_TR = fit.X_TR;
  result.p_H = fit.p_H;
  double sum = 0;
  for (size_t i = 0; i < hands.size(); ++i) sum += SquaredError(fit, hands[i], seen[i]);
  result.residual = std::sqrt(sum / static_cast<double>(hands.size()));
  result.left_out_residual = LeftOut(hands, seen);
  result.success = fit.p_H.norm() <= kFarthestHold;
  if (!result.success) result.problem = "the part is said to be farther from the hand than a hand can hold it";
  return result;
}

std::vector<JointAngles> CalibrationPoses(Arm arm) {
  const double side = arm == Arm::kLeft ? 1 : -1;
  const double poses[8][5] = {// shoulder pitch, outward roll, elbow yaw, elbow bend, wrist
                              {0.10, 0.10, -0.6, 0.30, 0.0},   {0.10, 0.60, -1.2, 0.60, 0.9},
                              {-0.35, 0.30, -0.2, 0.50, -0.9}, {-0.35, 0.70, -1.5, 0.25, 0.4},
                              {0.30, 0.40, -1.7, 0.90, -0.6},  {0.00, 0.00, -1.0, 1.10, 0.7},
                              {-0.60, 0.15, 0.3, 0.80, 1.2},   {0.25, 0.80, -0.4, 0.45, -1.2}};
  std::vector<JointAngles> result;
  const auto first = static_cast<size_t>(FirstJoint(arm));
  for (const auto& pose : poses) {
    JointAngles angles = RestAngles();
    angles[first] = pose[0];
    angles[first + 1] = side * pose[1];
    angles[first + 2] = side * pose[2];
    angles[first + 3] = -side * pose[3];
    angles[first + 4] = side * pose[4];
    result.push_back(ClampToLimits(angles));
  }
  return result;
}

}  // namespace coach
