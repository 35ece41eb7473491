// Reads PLY files (G. Turk, "The PLY Polygon File Format", 1994): ascii and binary of both byte orders.
#pragma once

#include <filesystem>

#include "common/geometry/mesh.h"

namespace coach {

/// Vertices (x, y, z of element `vertex`) in the file's own units and the faces (list `vertex_indices` or
/// `vertex_index` of element `face`), polygons cut into fans: they must be convex. Other elements and properties are
/// passed over. Nothing is believed before it was checked against the file's size.
/// @throws std::runtime_error saying what is wrong: no PLY, cut off, a face that names a vertex that does not exist.
TriangleMesh ReadPly(const std::filesystem::path& file);

}  // namespace coach
