#include "services/pose_filter/collision.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

constexpr int kGroupPoints = 12;

DistanceField Field(const TriangleMesh& mesh) {
  DistanceFieldOptions options;
  options.margin = 0.006;  // only the inside and its neighbourhood are asked for
  return DistanceField(mesh, options);
}

}  // namespace

CollisionShape::CollisionShape(const TriangleMesh& mesh, double spacing) : field_(Field(mesh)) {
  double area = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) area += mesh.Area(t);
  const int samples = std::clamp(static_cast<int>(area / (spacing * spacing)), 50, 4000);
  for (const SurfacePoint& s : SampleSurface(mesh, samples)) points_.push_back(s.p.cast<float>());
  // Corners are what enters the other part first; a dense mesh has samples enough.
  if (mesh.vertices.size() <= 500) {
    for (const Vector3& v : mesh.vertices) points_.push_back(v.cast<float>());
  }
  const MeshExtent extent = Extent(mesh);
  centre_ = extent.centre.cast<float>();
  for (const auto& p : points_) radius_ = std::max(radius_, (p - centre_).norm());
  Divide(0, static_cast<int>(points_.size()));
}

void CollisionShape::Divide(int first, int count) {
  const auto begin = points_.begin() + first, end = begin + count;
  Eigen::Vector3f low = *begin, high = *begin;
  for (auto p = begin; p != end; ++p) {
    low = low.cwiseMin(*p);
    high = high.cwiseMax(*p);
  }
  if (count <= kGroupPoints) {
    Group group{(low + high) / 2, 0, first, count};
    for (auto p = begin; p != end; ++p) group.radius = std::max(group.radius, (*p - group.centre).norm());
    groups_.push_back(group);
    return;
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::nth_element(begin, begin + count / 2, end,
                   [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a[axis] < b[axis]; });
  Divide(first, count / 2);
  Divide(first + count / 2, count - count / 2);
}

bool CollisionShape::HoldsPointOf(const CollisionShape& other, const Eigen::Isometry3f& X_PO, float allowed) const {
  for (const Group& group : other.groups_) {
    if (field_.Distance(X_PO * group.centre) > group.radius - allowed) continue;
    for (int i = group.first; i < group.first + group.count; ++i) {
      if (field_.Distance(X_PO * other.points_[static_cast<size_t>(i)]) < -allowed) return true;
    }
  }
  return false;
}

bool Overlap(const CollisionShape& a, const Pose& X_CA, const CollisionShape& b, const Pose& X_CB, double allowed) {
  const Eigen::Isometry3f X_AB = (X_CA.inverse() * X_CB).cast<float>();
  if ((X_AB * b.centre_ - a.centre_).norm() > a.radius_ + b.radius_) return false;
  const auto limit = static_cast<float>(allowed);
  return a.HoldsPointOf(b, X_AB, limit) || b.HoldsPointOf(a, X_AB.inverse(), limit);
}

}  // namespace coach
