// Meshes of simple solids, m, centred at the origin.
#pragma once

#include "common/geometry/mesh.h"

namespace coach {

TriangleMesh MakeBox(const Vector3& size);
/// Axis z.
TriangleMesh MakeCylinder(double radius, double height, int sides = 32);
TriangleMesh MakeBall(double radius, int rings = 16);

}  // namespace coach
