// Signed distance field of a rigid part: how far a point is from the surface, by one interpolation.
#pragma once

#include <array>
#include <vector>

#include "common/geometry/mesh.h"
#include "common/geometry/pose.h"

namespace coach {

struct DistanceFieldOptions {
  double voxel = 0.002;      ///< m, distance of the samples; larger if max_samples demands it
  double margin = 0.02;      ///< m, around the part's box
  int max_samples = 500000;  ///< memory: 4 bytes a sample
};

/// Distances on a regular grid in the part frame, trilinear between them; negative inside. Any mesh will do: concave,
/// thousands of triangles, with holes (MeshTree decides the side by winding number). The samples are exact; between
/// them the error is at most about a third of a voxel at edges, none on flat faces.
class DistanceField {
 public:
  /// @throws std::invalid_argument if the mesh is empty or an option is not positive.
  explicit DistanceField(const TriangleMesh& mesh, const DistanceFieldOptions& options = {});

  /// Signed distance of a point (part frame), m. Outside of the grid: that of the nearest point of the grid plus the
  /// distance to it, an upper bound.
  float Distance(const Eigen::Vector3f& p_P) const;

  struct Value {
    float distance = 0;                                  ///< m
    Eigen::Vector3f gradient = Eigen::Vector3f::Zero();  ///< of the interpolation; near unit length, zero on ridges
  };
  /// Distance and its gradient; the gradient of the interpolation inside the grid, towards the point outside of it.
  Value At(const Eigen::Vector3f& p_P) const;

  // The samples, for kernels of one's own: x runs fastest; sample (i, j, k) is at origin + voxel * (i, j, k).
  const std::array<int, 3>& size() const { return size_; }
  const Eigen::Vector3f& origin() const { return origin_; }  ///< m
  float voxel() const { return voxel_; }                     ///< m
  const std::vector<float>& samples() const { return samples_; }

 private:
  std::array<int, 3> size_{};
  Eigen::Vector3f origin_;
  float voxel_ = 0;
  std::vector<float> samples_;
};

}  // namespace coach
