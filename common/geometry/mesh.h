// Triangle meshes of parts.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "common/geometry/pose.h"

namespace coach {

/// Vertices in metres, part frame; triangles counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vector3> vertices;
  std::vector<std::array<int, 3>> triangles;

  Vector3 Normal(size_t triangle) const;  ///< unit, outward
  double Area(size_t triangle) const;     ///< m^2
};

struct MeshExtent {
  Vector3 low, high;    ///< m, axis-aligned box in the part frame
  Vector3 centre;       ///< m, middle of the box
  double diameter = 0;  ///< m, largest distance between two vertices (within 2 % for meshes of over 500 vertices)
};
MeshExtent Extent(const TriangleMesh& mesh);

/// A point of the surface with its outward normal, part frame.
struct SurfacePoint {
  Vector3 p;
  Vector3 n;
};

/// n points spread evenly over the surface (area-weighted, low discrepancy); the same for the same mesh.
std::vector<SurfacePoint> SampleSurface(const TriangleMesh& mesh, int n);

/// Volume (m^3) by the divergence theorem; negative if the triangles face inwards.
double SignedVolume(const TriangleMesh& mesh);

/// Reads PLY, OBJ, STL (Open3D). Merges equal vertices, drops triangles of no area, turns an inside-out mesh.
/// @param metres_per_unit 0.001 for a file in millimetres.
/// @throws std::runtime_error naming the file if it can't be read, is empty, has no extent or a coordinate is not
/// finite.
TriangleMesh ReadMesh(const std::filesystem::path& file, double metres_per_unit);

/// Writes an ASCII PLY. @throws std::runtime_error naming the file.
void WritePly(const std::filesystem::path& file, const TriangleMesh& mesh, double units_per_metre);

}  // namespace coach
