// Reads mesh files piece by piece: what a modelling program calls objects or nodes, each where it stands.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/mesh.h"

namespace coach {

struct MeshPiece {
  std::string name;   ///< of the object, node or file
  TriangleMesh mesh;  ///< m; equal vertices merged, no triangle without area, outside out
};

/// Objects of an OBJ, nodes of a GLB with their transforms applied; an STL or PLY is one piece. The files are read
/// without trust: sizes and indices are checked.
/// @param metres_per_unit 0.001 for a file in millimetres; a GLB is in metres by its standard, whatever this says.
/// @throws std::runtime_error naming the file and what is wrong with it: unknown format, damaged, empty, over 5 million
/// triangles.
std::vector<MeshPiece> ReadPieces(const std::filesystem::path& file, double metres_per_unit);

/// The parts of a mesh that are not joined by triangles, largest first; numbered names.
std::vector<MeshPiece> Connected(const MeshPiece& piece);

/// Merges vertices within 1 um, drops triangles without area, turns an inside-out mesh.
TriangleMesh Cleaned(const TriangleMesh& mesh);

/// All pieces as one. @throws std::runtime_error as ReadPieces does.
TriangleMesh ReadWhole(const std::filesystem::path& file, double metres_per_unit);

}  // namespace coach
