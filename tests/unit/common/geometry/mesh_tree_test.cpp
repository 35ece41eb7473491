#include "common/geometry/mesh_tree.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/test_meshes.h"

namespace coach {
namespace {

double BoxDistance(const Vector3& p, const Vector3& size) {
  const Vector3 q = p.cwiseAbs() - size / 2;
  return q.cwiseMax(0).norm() + std::min(0.0, q.maxCoeff());
}

Vector3 RandomPoint(std::mt19937_64& generator, double half) {
  std::uniform_real_distribution<double> u(-half, half);
  return {u(generator), u(generator), u(generator)};
}

TEST(MeshTree, BoxByFormula) {
  const Vector3 size(0.18, 0.03, 0.06);
  const MeshTree tree(BoxMesh(size));
  std::mt19937_64 generator(1);
  for (int i = 0; i < 2000; ++i) {
    const Vector3 p = RandomPoint(generator, 0.15);
    EXPECT_NEAR(tree.SignedDistance(p), BoxDistance(p, size), 1e-12);
    const ClosestPoint closest = tree.Closest(p);
    EXPECT_NEAR((closest.p - p).norm(), closest.distance, 1e-12);
    EXPECT_NEAR(BoxDistance(closest.p, size), 0, 1e-12);
  }
}

TEST(MeshTree, TorusByFormula) {
  const double ring = 0.05, tube = 0.015;
  const TriangleMesh mesh = TorusMesh(ring, tube, 120, 60);
  ASSERT_GT(SignedVolume(mesh), 0);
  const MeshTree tree(mesh);
  std::mt19937_64 generator(2);
  for (int i = 0; i < 2000; ++i) {
    const Vector3 p = RandomPoint(generator, 0.08);
    const double exact = std::hypot(std::hypot(p.x(), p.y()) - ring, p.z()) - tube;
    EXPECT_NEAR(tree.SignedDistance(p), exact, 1.2e-4) << "the mesh lies up to 0.1 mm inside the true torus";
  }
}

TEST(MeshTree, WindingNumberNearTheExactOne) {
  const TriangleMesh mesh = TorusMesh(0.05, 0.015, 60, 30);
  const MeshTree tree(mesh);
  std::mt19937_64 generator(3);
  for (int i = 0; i < 500; ++i) {
    const Vector3 p = RandomPoint(generator, 0.08);
    const double rho = std::hypot(std::hypot(p.x(), p.y()) - 0.05, p.z());
    if (std::abs(rho - 0.015) < 2e-4) continue;
    EXPECT_NEAR(tree.WindingNumber(p), rho < 0.015 ? 1 : 0, 0.05);
  }
}

TEST(MeshTree, HolesDoNotTurnItInsideOut) {
  TriangleMesh mesh = TorusMesh(0.05, 0.015, 60, 30);
  mesh.triangles.erase(mesh.triangles.begin() + 500, mesh.triangles.begin() + 520);
  const MeshTree tree(mesh);
  for (int i = 0; i < 60; ++i) {
    const double angle = 2 * std::numbers::pi * i / 60;
    EXPECT_LT(tree.SignedDistance({0.05 * std::cos(angle), 0.05 * std::sin(angle), 0}), -0.01);
    EXPECT_GT(tree.SignedDistance({0.09 * std::cos(angle), 0.09 * std::sin(angle), 0}), 0.02);
  }
}

TEST(MeshTree, RefusesAnEmptyMesh) { EXPECT_THROW(MeshTree(TriangleMesh{}), std::invalid_argument); }

}  // namespace
}  // namespace coach
