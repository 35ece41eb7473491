// Exact distances from a triangle mesh, and which side of it a point is on.
#pragma once

#include <vector>

#include "common/geometry/mesh.h"
#include "common/geometry/pose.h"

namespace coach {

struct ClosestPoint {
  Vector3 p = Vector3::Zero();  ///< m, on the surface
  double distance = 0;          ///< m, not negative
  int triangle = 0;             ///< index in the mesh
};

/// A bounding-volume tree over a mesh. Queries cost O(log triangles); holes, cracks and self-intersections are allowed.
class MeshTree {
 public:
  /// @throws std::invalid_argument if the mesh has no triangles.
  explicit MeshTree(const TriangleMesh& mesh);

  ClosestPoint Closest(const Vector3& p) const;

  /// Generalised winding number: 1 inside, 0 outside of a closed mesh, between them near the holes of an open one.
  /// Distant triangles are summed up as dipoles; the error is below 0.05. [Barill, Dickson, Schmidt, Levin, Jacobson:
  /// Fast Winding Numbers for Soups and Clouds, SIGGRAPH 2018]
  double WindingNumber(const Vector3& p) const;

  /// Distance to the surface, negative where the winding number is over a half. m
  double SignedDistance(const Vector3& p) const;

 private:
  struct Node {
    Vector3 low, high;         ///< box of the triangles
    Vector3 centre;            ///< area-weighted
    Vector3 area_normal;       ///< sum of area * normal, m^2
    double radius = 0;         ///< of the triangles about the centre, m
    int first = 0, count = 0;  ///< triangles of a leaf; count 0: an inner node
    int left = 0, right = 0;   ///< children of an inner node
  };
  int Build(int first, int count);

  std::vector<std::array<Vector3, 3>> corners_;
  std::vector<int> triangle_;  ///< index in the mesh of corners_[i]
  std::vector<Node> nodes_;
};

}  // namespace coach
