#include "tools/task/congruence.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/test_meshes.h"
#include "tools/task/mesh_pieces.h"

namespace coach {
namespace {

TriangleMesh Moved(TriangleMesh mesh, const Pose& X) {
  for (auto& v : mesh.vertices) v = X * v;
  return mesh;
}

TriangleMesh Centred(const TriangleMesh& mesh) { return Moved(mesh, Pose(Eigen::Translation3d(-MiddleOf(mesh)))); }

/// A prism over a regular polygon, axis z.
TriangleMesh Prism(int n, double radius, double height) {
  TriangleMesh mesh;
  for (int k = 0; k < n; ++k) {
    const double a = 2 * M_PI * k / n;
    for (const double z : {-height / 2, height / 2})
      mesh.vertices.emplace_back(radius * std::cos(a), radius * std::sin(a), z);
  }
  for (int k = 0; k < n; ++k) {
    const int a = 2 * k, b = 2 * ((k + 1) % n);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    if (k > 0 && k + 1 < n) {
      mesh.triangles.push_back({0, b, a});
      mesh.triangles.push_back({1, a + 1, b + 1});
    }
  }
  return mesh;
}

TEST(Congruence, AMovedCopyIsFoundWhereverItIs) {
  const TriangleMesh brick = ReadWhole(std::string(COACH_SOURCE_DIR) + "/deploy/tasks/meshes/brick_long.ply", 0.001);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int k = 0; k < 50; ++k) {
    const Pose X =
        MakePose(ExpRotation(3 * Vector3(u(random), u(random), u(random))), Vector3(u(random), u(random), u(random)));
    const TriangleMesh copy = Moved(brick, X);
    const auto found = Alignments(brick, copy);
    ASSERT_EQ(found.size(), 2u) << "the brick's half turn";
    const bool near = (found[0].matrix() - X.matrix()).norm() < 1e-3 || (found[1].matrix() - X.matrix()).norm() < 1e-3;
    EXPECT_TRUE(near);
  }
}

TEST(Congruence, AnotherShapeOrAMirrorImageIsNone) {
  TriangleMesh corner = BoxMesh({0.1, 0.05, 0.03});
  corner.vertices[0] *= 1.2;  // no symmetry left
  TriangleMesh mirrored = corner;
  for (auto& v : mirrored.vertices) v.x() = -v.x();
  for (auto& t : mirrored.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(Alignments(corner, corner).size(), 1u);
  EXPECT_TRUE(Alignments(corner, mirrored).empty());
  EXPECT_TRUE(Alignments(corner, BoxMesh({0.1, 0.05, 0.031})).empty());
}

TEST(Congruence, SymmetriesOfKnownBodies) {
  EXPECT_EQ(SymmetriesOf(Centred(BoxMesh({0.1, 0.05, 0.03}))).discrete.size(), 4u);
  EXPECT_EQ(SymmetriesOf(Centred(BoxMesh({0.1, 0.05, 0.05}))).discrete.size(), 8u);
  EXPECT_EQ(SymmetriesOf(Centred(BoxMesh({0.05, 0.05, 0.05}))).discrete.size(), 24u);
  EXPECT_EQ(SymmetriesOf(Prism(6, 0.03, 0.05)).discrete.size(), 12u);
  const SymmetryGroup wheel = SymmetriesOf(Prism(48, 0.03, 0.02));
  ASSERT_EQ(wheel.axes.size(), 1u);
  EXPECT_NEAR(std::abs(wheel.axes[0].z()), 1, 1e-6);
  EXPECT_EQ(wheel.discrete.size(), 2u) << "either face up";
}

}  // namespace
}  // namespace coach
