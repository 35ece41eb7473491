// Where parts can be without touching: tests between rigid bodies of the simulated world.
#pragma once

#include <vector>

#include "tools/simulator/random.h"
#include "tools/simulator/ray_tracer.h"

namespace coach {

/// The shapes of the movable things, for tests of contact. Thing i has its own mesh.
class Solids {
 public:
  /// @param meshes one per thing, part frame
  explicit Solids(const std::vector<TriangleMesh>& meshes);

  /// True if a point 1.5 mm under the surface of one is inside the other.
  bool Overlap(int a, const Pose& X_WA, int b, const Pose& X_WB) const;
  const MeshExtent& extent(int thing) const { return extents_.at(static_cast<size_t>(thing)); }
  /// Height (m) of the lowest point over the origin of a thing that is turned by R.
  double Lowest(int thing, const Matrix3& R) const;
  double Highest(int thing, const Matrix3& R) const;
  /// Orientations in which the thing rests firmly on one of its faces (not on a small end), yaw not varied; at least
  /// one.
  std::vector<Matrix3> Rests(int thing) const;

 private:
  RayTracer shapes_;
  std::vector<TriangleMesh> meshes_;
  std::vector<MeshExtent> extents_;
  std::vector<std::vector<Vector3>> skin_;  // points just under the surface
};

}  // namespace coach
