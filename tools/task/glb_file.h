// The geometry of a GLB file (glTF 2.0, binary): every node's mesh where the node's transforms put it.
#pragma once

#include <string>
#include <vector>

#include "tools/task/mesh_pieces.h"

namespace coach {

/// Triangles only; materials, skins, animations and morphs are left away. Everything must be in the file itself.
/// @param fallback name of nodes without one
/// @throws std::runtime_error or nlohmann's exceptions for a file that is damaged or uses what is not read (compressed
/// or sparse accessors, external buffers)
std::vector<MeshPiece> ReadGlb(const std::string& bytes, const std::string& fallback);

}  // namespace coach
