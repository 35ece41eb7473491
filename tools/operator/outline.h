// Outlines of parts: what is drawn over the camera's picture, and seen from above.
#pragma once

#include <vector>

#include "common/geometry/camera.h"
#include "common/geometry/mesh.h"
#include "common/geometry/pose.h"

namespace coach {

/// A closed line; the last point is joined to the first.
using Polygon = std::vector<Eigen::Vector2f>;

/// The mesh with its vertices moved to the nodes of a grid until it has at most `max_triangles` (an unchanged copy if
/// it has no more). For drawing only: the surface moves by up to a grid cell.
TriangleMesh Simplified(const TriangleMesh& mesh, size_t max_triangles);

/// The silhouette of a mesh in the picture (px), holes included; what lies outside the image is cut. Other parts do not
/// hide it. Triangles nearer than 5 cm or behind the camera are left out. Corners are within 1 px.
std::vector<Polygon> Silhouette(const TriangleMesh& mesh, const Pose& X_CP, const CameraModel& camera);

/// The silhouette seen along -z of frame F from far away: x and y of frame F, m. Corners are within `resolution` (m).
std::vector<Polygon> SilhouetteFromAbove(const TriangleMesh& mesh, const Pose& X_FP, double resolution);

}  // namespace coach
