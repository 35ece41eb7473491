// Which rigid motions lay one mesh on another: equal parts, and the symmetries of one part.
#pragma once

#include <vector>

#include "common/geometry/mesh.h"
#include "common/geometry/symmetry.h"

namespace coach {

struct CongruenceOptions {
  double tolerance = 0.0003;  ///< m; vertices and surface must fall on each other within it
  int most = 1000;            ///< motions that are looked for
};

/// Every X with X * a = b. Both must have the same vertices (a copy that was tessellated anew is another shape). The
/// first found is enough with most = 1.
std::vector<Pose> Alignments(const TriangleMesh& a, const TriangleMesh& b, const CongruenceOptions& options = {});

/// Mean of the vertices: a point that every symmetry leaves where it is.
Vector3 MiddleOf(const TriangleMesh& mesh);

/// Rotations about the origin, where MiddleOf(mesh) must be, that lay the mesh on itself. Twelve or more about one axis
/// are a body of revolution.
SymmetryGroup SymmetriesOf(const TriangleMesh& mesh, const CongruenceOptions& options = {});

}  // namespace coach
