#include "common/geometry/symmetry.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace coach {
namespace {

constexpr size_t kLargestGroup = 240;

bool Contains(const std::vector<Matrix3>& set, const Matrix3& R) {
  return std::any_of(set.begin(), set.end(), [&](const Matrix3& S) { return (S - R).norm() < 1e-2; });
}

/// R turned about its own axis a so that it is nearest to `reference`: maximises trace(reference^T R Rot(a, t)) over t.
Matrix3 NearestAboutAxis(const Matrix3& R, const Vector3& a, const Matrix3& reference) {
  const Matrix3 M = reference.transpose() * R;
  // trace(M Rot(a,t)) = k + cos(t) (tr M - a^T M a) + sin(t) * sum(M .* skew(a)^T)
  const double c = M.trace() - a.dot(M * a);
  const double s = a.x() * (M(1, 2) - M(2, 1)) + a.y() * (M(2, 0) - M(0, 2)) + a.z() * (M(0, 1) - M(1, 0));
  return R * ExpRotation(std::atan2(s, c) * a);
}

}  // namespace

SymmetryGroup MakeSymmetryGroup(const std::vector<Matrix3>& discrete, const std::vector<Vector3>& axes) {
  SymmetryGroup group;
  for (const Vector3& axis : axes) {
    if (!(axis.norm() > 1e-9)) throw std::invalid_argument("a symmetry axis has no length");
    group.axes.push_back(axis.normalized());
  }
  std::vector<Matrix3> generators;
  for (const Matrix3& R : discrete) {
    if (!((R * R.transpose() - Matrix3::Identity()).norm() < 1e-3) || R.determinant() < 0)
      throw std::invalid_argument("a discrete symmetry is no rotation matrix");
    generators.push_back(MakePose(R, Vector3::Zero()).linear());
  }
  for (size_t i = 0; i < group.discrete.size(); ++i) {  // grows while we walk it
    for (const Matrix3& G : generators) {
      const Matrix3 R = group.discrete[i] * G;
      if (!Contains(group.discrete, R)) group.discrete.push_back(R);
      if (group.discrete.size() > kLargestGroup)
        throw std::invalid_argument("the discrete symmetries form no finite group");
    }
  }
  return group;
}

Pose NearestEquivalent(const SymmetryGroup& group, const Pose& X_AP, const Pose& reference) {
  Matrix3 best = X_AP.linear();
  double best_trace = -4;
  if (group.axes.size() > 1) {
    best = reference.linear();  // a sphere: every orientation is the same
  } else {
    for (const Matrix3& S : group.discrete) {
      Matrix3 R = X_AP.linear() * S;
      for (const Vector3& axis : group.axes) R = NearestAboutAxis(R, axis, reference.linear());
      const double trace = reference.linear().cwiseProduct(R).sum();
      if (trace > best_trace + 1e-12) {
        best_trace = trace;
        best = R;
      }
    }
  }
  Pose X = X_AP;
  X.linear() = best;
  return X;
}

double RotationError(const SymmetryGroup& group, const Matrix3& X, const Matrix3& Y) {
  Pose pose_x = Pose::Identity(), pose_y = Pose::Identity();
  pose_x.linear() = X;
  pose_y.linear() = Y;
  return RotationAngle(X.transpose() * NearestEquivalent(group, pose_y, pose_x).linear());
}

std::vector<Matrix3> SampledElements(const SymmetryGroup& group, double step) {
  std::vector<Matrix3> out = group.discrete;
  for (const Vector3& axis : group.axes) {
    const int n = std::max(1, static_cast<int>(std::lround(2 * std::numbers::pi / step)));
    std::vector<Matrix3> grown;
    for (const Matrix3& S : out) {
      for (int i = 0; i < n; ++i) grown.push_back(S * ExpRotation(2 * std::numbers::pi * i / n * axis));
    }
    out = std::move(grown);
  }
  return out;
}

}  // namespace coach
