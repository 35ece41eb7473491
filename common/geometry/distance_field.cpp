#include "common/geometry/distance_field.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/geometry/mesh_tree.h"

namespace coach {

DistanceField::DistanceField(const TriangleMesh& mesh, const DistanceFieldOptions& options) {
  if (!(options.voxel > 0) || !(options.margin > 0) || options.max_samples < 8) {
    throw std::invalid_argument("distance field: voxel and margin must be positive, max_samples at least 8");
  }
  const MeshTree tree(mesh);
  const MeshExtent extent = Extent(mesh);
  const Vector3 low = extent.low.array() - options.margin;
  const Vector3 length = extent.high - extent.low + Vector3::Constant(2 * options.margin);
  double voxel = options.voxel;
  const auto samples_along = [&](int axis) { return std::ceil(length[axis] / voxel) + 1; };
  while (samples_along(0) * samples_along(1) * samples_along(2) > options.max_samples) voxel *= 1.05;
  for (int axis = 0; axis < 3; ++axis) size_[static_cast<size_t>(axis)] = static_cast<int>(samples_along(axis));
  voxel_ = static_cast<float>(voxel);
  origin_ = low.cast<float>();
  samples_.reserve(static_cast<size_t>(size_[0]) * static_cast<size_t>(size_[1]) * static_cast<size_t>(size_[2]));
  for (int k = 0; k < size_[2]; ++k) {
    for (int j = 0; j < size_[1]; ++j) {
      for (int i = 0; i < size_[0]; ++i) {
        samples_.push_back(static_cast<float>(tree.SignedDistance(low + voxel * Vector3(i, j, k))));
      }
    }
  }
}

float DistanceField::Distance(const Eigen::Vector3f& p_P) const {
  // As At, without the gradient: this is the inner loop of overlap tests.
  const float scale = 1 / voxel_;
  std::array<int, 3> cell;
  std::array<float, 3> f;
  float squared_outside = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const float at = (p_P[i] - origin_[i]) * scale;
    const float inside = std::min(std::max(0.0F, at), static_cast<float>(size_[axis] - 1));  // NaN: 0
    cell[axis] = std::min(static_cast<int>(inside), size_[axis] - 2);
    f[axis] = inside - static_cast<float>(cell[axis]);
    squared_outside += (at - inside) * (at - inside);
  }
  const auto nx = static_cast<size_t>(size_[0]), nxy = nx * static_cast<size_t>(size_[1]);
  const float* s = samples_.data() + static_cast<size_t>(cell[0]) + nx * static_cast<size_t>(cell[1]) +
                   nxy * static_cast<size_t>(cell[2]);
  const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
  const float y0 = mix(mix(s[0], s[1], f[0]), mix(s[nx], s[nx + 1], f[0]), f[1]);
  const float y1 = mix(mix(s[nxy], s[nxy + 1], f[0]), mix(s[nxy + nx], s[nxy + nx + 1], f[0]), f[1]);
  const float distance = mix(y0, y1, f[2]);
  return squared_outside > 0 ? distance + voxel_ * std::sqrt(squared_outside) : distance;
}

DistanceField::Value DistanceField::At(const Eigen::Vector3f& p_P) const {
  const Eigen::Vector3f last(static_cast<float>(size_[0] - 1), static_cast<float>(size_[1] - 1),
                             static_cast<float>(size_[2] - 1));
  const Eigen::Vector3f at = (p_P - origin_) / voxel_;
  const Eigen::Vector3f inside = (at.array() > 0).select(at, 0.0F).cwiseMin(last);  // NaN: 0
  const Eigen::Vector3f cell = inside.array().floor().matrix().cwiseMin(last - Eigen::Vector3f::Ones());
  const Eigen::Vector3f f = inside - cell;
  const auto nx = static_cast<size_t>(size_[0]), nxy = nx * static_cast<size_t>(size_[1]);
  const float* s = samples_.data() + static_cast<size_t>(cell.x()) + nx * static_cast<size_t>(cell.y()) +
                   nxy * static_cast<size_t>(cell.z());
  const auto mix = [](float a, float b, float t) { return a + t * (b - a); };
  // Along x, then y, then z; the differences along the way are the gradient.
  const float x00 = mix(s[0], s[1], f.x()), x10 = mix(s[nx], s[nx + 1], f.x());
  const float x01 = mix(s[nxy], s[nxy + 1], f.x()), x11 = mix(s[nxy + nx], s[nxy + nx + 1], f.x());
  const float y0 = mix(x00, x10, f.y()), y1 = mix(x01, x11, f.y());
  Value value{mix(y0, y1, f.z()), {}};
  const float outside = (at - inside).norm() * voxel_;
  if (outside > 0) {
    value.gradient = (at - inside).normalized();
    value.distance += outside;
    return value;
  }
  value.gradient = Eigen::Vector3f(mix(mix(s[1] - s[0], s[nx + 1] - s[nx], f.y()),
                                       mix(s[nxy + 1] - s[nxy], s[nxy + nx + 1] - s[nxy + nx], f.y()), f.z()),
                                   mix(x10 - x00, x11 - x01, f.z()), y1 - y0) /
                   voxel_;
  return value;
}

}  // namespace coach
