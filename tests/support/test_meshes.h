// Meshes for tests.
#pragma once

#include <cmath>
#include <numbers>

#include "common/geometry/mesh.h"

namespace coach {

/// Axis-aligned box about the origin; 12 triangles.
inline TriangleMesh BoxMesh(const Vector3& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(size.cwiseProduct(Vector3((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2) - 0.5)));
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Torus about z: concave, 2 * around * along triangles.
inline TriangleMesh TorusMesh(double ring, double tube, int around, int along) {
  TriangleMesh mesh;
  const double step_u = 2 * std::numbers::pi / around, step_v = 2 * std::numbers::pi / along;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      const double r = ring + tube * std::cos(step_v * j);
      mesh.vertices.emplace_back(r * std::cos(step_u * i), r * std::sin(step_u * i), tube * std::sin(step_v * j));
    }
  }
  const auto index = [&](int i, int j) { return i % around * along + j % along; };
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < along; ++j) {
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i, j + 1)});
      mesh.triangles.push_back({index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  return mesh;
}

}  // namespace coach
