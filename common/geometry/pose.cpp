#include "common/geometry/pose.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

Matrix3 Skew(const Vector3& v) {
  Matrix3 S;
  S << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return S;
}

}  // namespace

Matrix3 ExpRotation(const Vector3& w) {
  const double angle2 = w.squaredNorm();
  const double angle = std::sqrt(angle2);
  const double a = angle < 1e-6 ? 1.0 - angle2 / 6.0 : std::sin(angle) / angle;
  const double b = angle < 1e-6 ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle)) / angle2;
  const Matrix3 W = Skew(w);
  return Matrix3::Identity() + a * W + b * W * W;
}

Vector3 LogRotation(const Matrix3& R) {
  // Through the quaternion: well conditioned at 0 and at pi alike.
  Eigen::Quaterniond q(R);
  if (q.w() < 0) q.coeffs() *= -1;
  const double sine = q.vec().norm();
  if (sine < 1e-12) return 2.0 * q.vec();
  return 2.0 * std::atan2(sine, q.w()) / sine * q.vec();
}

Pose Perturb(const Pose& X_AB, const Vector6& xi) {
  Pose X;
  X.linear() = ExpRotation(xi.tail<3>()) * X_AB.linear();
  X.translation() = X_AB.translation() + xi.head<3>();
  return X;
}

Vector6 Difference(const Pose& from, const Pose& to) {
  Vector6 xi;
  xi.head<3>() = to.translation() - from.translation();
  xi.tail<3>() = LogRotation(to.linear() * from.linear().transpose());
  return xi;
}

Matrix6 RotateCovariance(const Matrix3& R_AB, const Matrix6& covariance_B) {
  Matrix6 J = Matrix6::Zero();
  J.topLeftCorner<3, 3>() = R_AB;
  J.bottomRightCorner<3, 3>() = R_AB;
  return J * covariance_B * J.transpose();
}

Matrix6 ComposeCovariance(const Pose& X_AB, const Matrix6& covariance_AB, const Pose& X_BC,
                          const Matrix6& covariance_BC) {
  // p_AC = p_AB + R_AB p_BC moves by dp + w x (R_AB p_BC); R_AC turns by w.
  Matrix6 J = Matrix6::Identity();
  J.topRightCorner<3, 3>() = -Skew(X_AB.linear() * X_BC.translation());
  return J * covariance_AB * J.transpose() + RotateCovariance(X_AB.linear(), covariance_BC);
}

Pose MakePose(const Matrix3& R, const Vector3& p) {
  const Eigen::JacobiSVD<Matrix3> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0) U.col(2) *= -1;
  Pose X;
  X.linear() = U * svd.matrixV().transpose();
  X.translation() = p;
  X.makeAffine();
  return X;
}

double RotationAngle(const Matrix3& R) { return LogRotation(R).norm(); }

}  // namespace coach
