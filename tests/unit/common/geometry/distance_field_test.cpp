#include "common/geometry/distance_field.h"

#include <gtest/gtest.h>

#include <random>

#include "common/geometry/mesh_tree.h"
#include "tests/support/test_meshes.h"

namespace coach {
namespace {

Eigen::Vector3f RandomPoint(std::mt19937_64& generator, const Eigen::Vector3f& half) {
  std::uniform_real_distribution<float> u(-1, 1);
  return half.cwiseProduct(Eigen::Vector3f(u(generator), u(generator), u(generator)));
}

TEST(DistanceField, AgreesWithTheTreeEverywhere) {
  const TriangleMesh meshes[] = {BoxMesh({0.09, 0.03, 0.03}), TorusMesh(0.04, 0.012, 80, 40)};
  for (const TriangleMesh& mesh : meshes) {
    const MeshTree tree(mesh);
    const DistanceField field(mesh);
    std::mt19937_64 generator(1);
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector3f p = RandomPoint(generator, {0.06F, 0.03F, 0.03F});
      EXPECT_NEAR(field.Distance(p), tree.SignedDistance(p.cast<double>()), field.voxel() / 2.5);
    }
  }
}

TEST(DistanceField, ExactOnFlatFaces) {
  const DistanceField field(BoxMesh({0.09, 0.03, 0.03}));
  for (float z = -0.01F; z < 0.01F; z += 0.0007F) {
    const auto value = field.At({0.011F, 0.0013F, 0.015F + z});
    EXPECT_NEAR(value.distance, z, 1e-6);
    EXPECT_NEAR((value.gradient - Eigen::Vector3f::UnitZ()).norm(), 0, 1e-3);
  }
}

TEST(DistanceField, GradientIsTheDerivativeOfTheInterpolation) {
  const DistanceField field(TorusMesh(0.04, 0.012, 40, 20));
  std::mt19937_64 generator(5);
  int tested = 0;
  for (int i = 0; i < 500; ++i) {
    const Eigen::Vector3f p = RandomPoint(generator, {0.06F, 0.06F, 0.02F});
    const Eigen::Vector3f cell = (p - field.origin()) / field.voxel();
    const Eigen::Vector3f fraction = cell.array() - cell.array().floor();
    if (fraction.minCoeff() < 0.1 || fraction.maxCoeff() > 0.9) continue;  // the gradient jumps between cells
    ++tested;
    const auto value = field.At(p);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3f h = 1e-4F * Eigen::Vector3f::Unit(axis);
      EXPECT_NEAR(value.gradient[axis], (field.Distance(p + h) - field.Distance(p - h)) / 2e-4F, 2e-3);
    }
  }
  EXPECT_GT(tested, 100);
}

TEST(DistanceField, OutsideOfTheGridDistanceGoesOn) {
  const TriangleMesh mesh = BoxMesh({0.09, 0.03, 0.03});
  const DistanceField field(mesh);
  const auto value = field.At({0.5F, 0, 0});
  EXPECT_NEAR(value.distance, 0.5 - 0.045, 1e-5);
  EXPECT_NEAR(value.gradient.x(), 1, 1e-6);
  const MeshTree tree(mesh);
  std::mt19937_64 generator(6);
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3f p = RandomPoint(generator, {0.5F, 0.5F, 0.5F});
    const double exact = tree.SignedDistance(p.cast<double>());
    EXPECT_GE(field.Distance(p), exact - field.voxel());
    EXPECT_LE(field.Distance(p), exact + 0.08);
  }
}

TEST(DistanceField, BothQueriesAgree) {
  const DistanceField field(TorusMesh(0.04, 0.012, 40, 20));
  std::mt19937_64 generator(7);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3f p = RandomPoint(generator, {0.1F, 0.1F, 0.06F});
    EXPECT_NEAR(field.Distance(p), field.At(p).distance, 1e-6);
  }
  // A point that is none is looked up inside of the grid.
  const Eigen::Vector3f nowhere(std::nanf(""), 0, 0);
  EXPECT_GT(field.Distance(nowhere), -1);
  EXPECT_GT(field.At(nowhere).distance, -1);
}

TEST(DistanceField, KeepsToItsMemory) {
  DistanceFieldOptions options;
  options.max_samples = 5000;
  const DistanceField field(BoxMesh({0.3, 0.2, 0.2}), options);
  EXPECT_LE(field.samples().size(), 5000u);
  EXPECT_NEAR(field.Distance({0, 0, 0}), -0.1, 0.02);
  options.voxel = 0;
  EXPECT_THROW(DistanceField(BoxMesh({0.3, 0.2, 0.2}), options), std::invalid_argument);
}

TEST(DistanceField, ThousandsOfTrianglesWithHoles) {
  TriangleMesh mesh = TorusMesh(0.04, 0.012, 100, 50);  // 10,000
  for (size_t i = 0; i < mesh.triangles.size(); i += 97)
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<ptrdiff_t>(i));
  const DistanceField field(mesh);
  EXPECT_NEAR(field.Distance({0.04F, 0, 0}), -0.012, 1e-3);
  EXPECT_NEAR(field.Distance({0, 0, 0}), 0.028, 1e-3);
}

}  // namespace
}  // namespace coach
