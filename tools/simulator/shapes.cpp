#include "tools/simulator/shapes.h"

#include <cmath>

namespace coach {

TriangleMesh MakeBox(const Vector3& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(0.5 * Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1).cwiseProduct(size));
  }
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
  return mesh;
}

TriangleMesh MakeCylinder(double radius, double height, int sides) {
  TriangleMesh mesh;
  for (int i = 0; i < sides; ++i) {
    const double a = 2 * M_PI * i / sides;
    mesh.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), -0.5 * height);
    mesh.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), 0.5 * height);
  }
  const int bottom = 2 * sides, top = bottom + 1;
  mesh.vertices.emplace_back(0, 0, -0.5 * height);
  mesh.vertices.emplace_back(0, 0, 0.5 * height);
  for (int i = 0; i < sides; ++i) {
    const int a = 2 * i, b = 2 * ((i + 1) % sides);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    mesh.triangles.push_back({bottom, b, a});
    mesh.triangles.push_back({top, a + 1, b + 1});
  }
  return mesh;
}

TriangleMesh MakeBall(double radius, int rings) {
  TriangleMesh mesh;
  const int sides = 2 * rings;
  for (int r = 1; r < rings; ++r) {
    const double polar = M_PI * r / rings;
    for (int s = 0; s < sides; ++s) {
      const double a = 2 * M_PI * s / sides;
      mesh.vertices.push_back(radius *
                              Vector3(std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar)));
    }
  }
  const int north = static_cast<int>(mesh.vertices.size()), south = north + 1;
  mesh.vertices.emplace_back(0, 0, radius);
  mesh.vertices.emplace_back(0, 0, -radius);
  for (int s = 0; s < sides; ++s) {
    const int next = (s + 1) % sides, last = (rings - 2) * sides;
    mesh.triangles.push_back({north, s, next});
    mesh.triangles.push_back({south, last + next, last + s});
    for (int r = 0; r + 2 < rings; ++r) {
      const int a = r * sides;
      mesh.triangles.push_back({a + s, a + sides + s, a + sides + next});
      mesh.triangles.push_back({a + s, a + sides + next, a + next});
    }
  }
  return mesh;
}

}  // namespace coach
