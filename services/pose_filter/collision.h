// Two solid parts are not in one place: equation [5] of the paper.
#pragma once

#include <vector>

#include "common/geometry/distance_field.h"
#include "common/geometry/mesh.h"
#include "common/geometry/pose.h"

namespace coach {

struct CollisionOptions {
  double factor = 0.01;              ///< kappa of [5]: weight of a particle in which any two parts overlap
  double allowed = 0.002;            ///< m, overlap that does not count: measured poses of touching parts overlap
  double allowed_connected = 0.003;  ///< m, the same for two parts with a candidate or made connection
};

/// A part's surface and inside, prepared for overlap tests.
class CollisionShape {
 public:
  /// @param spacing m, of the surface points that are tested.
  explicit CollisionShape(const TriangleMesh& mesh, double spacing = 0.005);

  const DistanceField& field() const { return field_; }

 private:
  friend bool Overlap(const CollisionShape&, const Pose&, const CollisionShape&, const Pose&, double);
  /// Whether a surface point of `other` lies deeper than `allowed` in this part.
  bool HoldsPointOf(const CollisionShape& other, const Eigen::Isometry3f& X_PO, float allowed) const;

  struct Group {
    Eigen::Vector3f centre;
    float radius = 0;
    int first = 0, count = 0;
  };
  void Divide(int first, int count);

  DistanceField field_;
  Eigen::Vector3f centre_;
  float radius_ = 0;
  std::vector<Eigen::Vector3f> points_;
  std::vector<Group> groups_;
};

/// Whether two parts overlap by more than `allowed` (m): a surface point of one is that deep inside the other. One
/// inside the other overlaps. Touches narrower than the spacing of the points may be missed.
bool Overlap(const CollisionShape& a, const Pose& X_CA, const CollisionShape& b, const Pose& X_CB, double allowed);

}  // namespace coach
