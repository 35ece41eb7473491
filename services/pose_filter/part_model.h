// What the filter needs to know of a part's shape, computed once from its mesh.
#pragma once

#include <vector>

#include "common/assembly/task.h"
#include "common/geometry/mesh.h"
#include "common/geometry/pose.h"

namespace coach {

/// An edge of the mesh with the two faces that meet in it. A boundary edge has the same face twice.
struct ModelEdge {
  int a = 0, b = 0;            ///< vertices
  int face_1 = 0, face_2 = 0;  ///< triangles
  int opposite_1 = 0;          ///< the vertex of face_1 that is not on the edge
  int opposite_2 = 0;
};

/// Shape of one part type. All in metres, part frame.
struct PartModel {
  TriangleMesh mesh;                  ///< at most PartModelOptions::most_triangles
  std::vector<Vector3> normals;       ///< unit, outward, per triangle
  std::vector<ModelEdge> edges;       ///< edges where the surface bends, boundaries included
  std::vector<SurfacePoint> surface;  ///< evenly spread
  MeshExtent extent;
  SymmetryGroup symmetries;
  Vector3 principal_half = Vector3::Zero();    ///< half lengths along the principal axes, longest first
  Vector3 principal_centre = Vector3::Zero();  ///< middle of that box
  Matrix3 principal_axes =
      Matrix3::Identity();  ///< columns, same order: of inertia, or where those are ambiguous normals
  /// Motions (not symmetries) that map the part nearly onto itself: half and quarter turns about the principal axes
  /// under which the principal box stays put. A tracker that slipped into one of them sees almost the same image.
  std::vector<Pose> near_symmetries;
  /// Rotations covering SO(3) modulo the symmetries.
  std::vector<Matrix3> orientations;
  /// Rotations R_TP in which the part rests on the table on a face of its convex hull, about 12 turns each.
  std::vector<Matrix3> resting;
};

struct PartModelOptions {
  int most_triangles = 1500;      ///< larger meshes are decimated
  int surface_points = 1200;      ///< samples of the surface
  double orientation_step = 0.5;  ///< rad, spacing of the cover of SO(3)
};

PartModel MakePartModel(const PartType& type, const PartModelOptions& options = {});

/// Rotations about `step` radians apart that cover SO(3), the same for the same arguments; symmetric equivalents are
/// left out.
std::vector<Matrix3> CoverOfRotations(double step, const SymmetryGroup& symmetries);

}  // namespace coach
