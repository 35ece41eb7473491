#include "services/pose_filter/depth_renderer.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <random>

#include "tests/support/test_meshes.h"

namespace coach {
namespace {

CameraModel Camera() {
  CameraModel camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 570;
  camera.fy = 575;
  camera.cx = 318.3;
  camera.cy = 241.7;
  return camera;
}

struct Reference {
  double depth = std::numeric_limits<double>::infinity();  ///< m
  bool uncertain = false;  ///< within the tolerance of an edge of some triangle: coverage may differ
};

/// Casts a ray in double precision at every triangle, from both sides. Edges are compared in the image by clipping each
/// at the near plane.
Reference CastRay(const TriangleMesh& mesh, const PixelGrid& grid, const Pose& X_CP, int i, int j) {
  const Vector3 ray((i - grid.cx) / grid.fx, (j - grid.cy) / grid.fy, 1);
  Reference result;
  for (const auto& t : mesh.triangles) {
    const Vector3 p[3] = {X_CP * mesh.vertices[t[0]], X_CP * mesh.vertices[t[1]], X_CP * mesh.vertices[t[2]]};
    for (int e = 0; e < 3; ++e) {
      Vector3 a = p[e], b = p[(e + 1) % 3];
      if (a.z() < 1e-3 && b.z() < 1e-3) continue;
      if (a.z() < 1e-3) std::swap(a, b);
      if (b.z() < 1e-3) b = a + (a.z() - 1e-3) / (a.z() - b.z()) * (b - a);
      const Eigen::Vector2d qa(grid.fx * a.x() / a.z() + grid.cx, grid.fy * a.y() / a.z() + grid.cy);
      const Eigen::Vector2d qb(grid.fx * b.x() / b.z() + grid.cx, grid.fy * b.y() / b.z() + grid.cy);
      const Eigen::Vector2d q(i, j), d = qb - qa;
      const double s = d.squaredNorm() > 0 ? std::clamp((q - qa).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
      if ((qa + s * d - q).norm() < 4e-3) result.uncertain = true;
    }
    const Vector3 n = (p[1] - p[0]).cross(p[2] - p[0]);
    const double z = n.dot(p[0]) / n.dot(ray);
    if (!(z > 0)) continue;
    if (std::abs(z - kNearPlane) < 1e-5) result.uncertain = true;
    if (z < kNearPlane) continue;
    const Vector3 hit = z * ray;
    bool inside = true;
    for (int e = 0; e < 3; ++e) inside &= (p[(e + 1) % 3] - p[e]).cross(hit - p[e]).dot(n) >= 0;
    if (inside) result.depth = std::min(result.depth, z);
  }
  return result;
}

void ExpectAgreement(const TriangleMesh& mesh, const PixelGrid& grid, const Pose& X_CP, int* drawn = nullptr) {
  const RenderMesh prepared(mesh);
  RenderedDepth tile;
  RenderDepth(prepared, grid, X_CP, tile);
  int uncertain = 0, points = 0;
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i) {
      const int x = i - tile.area.x, y = j - tile.area.y;
      const bool near_tile = x >= -5 && y >= -5 && x < tile.area.width + 5 && y < tile.area.height + 5;
      if (!near_tile && (i + j) % 11 != 0) continue;  // a sample of what is far from the part
      const bool in_tile = x >= 0 && y >= 0 && x < tile.area.width && y < tile.area.height;
      const float depth = in_tile ? tile.row(y)[x] : RenderedDepth::kEmpty;
      const Reference expected = CastRay(mesh, grid, X_CP, i, j);
      if (expected.uncertain) {
        ++uncertain;
        continue;
      }
      ASSERT_EQ(std::isinf(depth), std::isinf(expected.depth)) << i << ", " << j << " at\n" << X_CP.matrix();
      if (std::isinf(depth)) continue;
      ++points;
      ASSERT_NEAR(depth, expected.depth, 1e-5 * expected.depth) << i << ", " << j << " at\n" << X_CP.matrix();
    }
  }
  EXPECT_LE(uncertain, points / 10 + 10);
  if (drawn) *drawn += points;
}

Pose RandomPose(std::mt19937_64& generator, double x, double y, double near, double far) {
  std::uniform_real_distribution<double> u(-1, 1);
  std::normal_distribution<double> n;
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(n(generator), n(generator), n(generator), n(generator)).normalized().matrix();
  pose.translation() << x * u(generator), y * u(generator), near + (far - near) * (u(generator) + 1) / 2;
  return pose;
}

class DepthRenderer : public testing::TestWithParam<int64_t> {
 protected:
  void SetUp() override {
    if ((hwy::SupportedTargets() & GetParam()) == 0) GTEST_SKIP() << "not on this processor";
    hwy::SetSupportedTargetsForTest(GetParam());
  }
  void TearDown() override { hwy::SetSupportedTargetsForTest(0); }
};

TEST_P(DepthRenderer, AgreesWithRayCasting) {
  std::mt19937_64 generator(1);
  const TriangleMesh meshes[] = {BoxMesh({0.18, 0.03, 0.03}), TorusMesh(0.05, 0.02, 16, 10)};
  int drawn = 0;
  for (const TriangleMesh& mesh : meshes) {
    for (const int step : {5, 9}) {
      for (int k = 0; k < 12; ++k) {
        ExpectAgreement(mesh, SampledGrid(Camera(), step), RandomPose(generator, 0.3, 0.2, 0.5, 1.2), &drawn);
      }
    }
  }
  EXPECT_GT(drawn, 4000);
}

TEST_P(DepthRenderer, ClipsAtTheBorderOfTheImage) {
  std::mt19937_64 generator(2);
  const PixelGrid grid = SampledGrid(Camera(), 6);
  int drawn = 0;
  for (int k = 0; k < 24; ++k) {
    Pose pose = RandomPose(generator, 0.02, 0.02, 0.4, 0.8);
    const double z = pose.translation().z();
    // At one of the four borders or corners.
    if (k % 3 != 0) pose.translation().x() += (k & 1 ? 0.56 : -0.56) * z;
    if (k % 3 != 1) pose.translation().y() += (k & 2 ? 0.42 : -0.42) * z;
    ExpectAgreement(BoxMesh({0.18, 0.09, 0.03}), grid, pose, &drawn);
  }
  EXPECT_GT(drawn, 1000);
}

TEST_P(DepthRenderer, CutsAtTheNearPlane) {
  std::mt19937_64 generator(3);
  const PixelGrid grid = SampledGrid(Camera(), 16);
  int drawn = 0;
  for (int k = 0; k < 40; ++k) {
    ExpectAgreement(k % 2 ? BoxMesh({0.18, 0.06, 0.03}) : TorusMesh(0.05, 0.02, 8, 6), grid,
                    RandomPose(generator, 0.05, 0.05, -0.05, 0.15), &drawn);
  }
  EXPECT_GT(drawn, 1000);
}

TEST_P(DepthRenderer, OpenAndInsideOutMeshesShowBothSides) {
  TriangleMesh open = BoxMesh({0.18, 0.06, 0.03}), turned = open;
  open.triangles.resize(9);
  for (auto& t : turned.triangles) std::swap(t[0], t[1]);
  std::mt19937_64 generator(4);
  for (int k = 0; k < 5; ++k) {
    const Pose pose = RandomPose(generator, 0.2, 0.2, 0.5, 0.9);
    ExpectAgreement(open, SampledGrid(Camera(), 4), pose);
    ExpectAgreement(turned, SampledGrid(Camera(), 4), pose);
  }
}

TEST_P(DepthRenderer, DenseMeshHasNoCracks) {
  const TriangleMesh mesh = TorusMesh(0.05, 0.02, 100, 50);
  const RenderMesh prepared(mesh);
  const PixelGrid grid = SampledGrid(Camera(), 1);
  std::mt19937_64 generator(5);
  for (int k = 0; k < 3; ++k) {
    const Pose pose = RandomPose(generator, 0.1, 0.1, 0.5, 0.7);
    RenderedDepth tile;
    RenderDepth(prepared, grid, pose, tile);
    for (int y = 1; y + 1 < tile.area.height; ++y) {
      for (int x = 1; x + 1 < tile.area.width; ++x) {
        const float *row = tile.row(y), depth = row[x];
        const bool surrounded = std::isfinite(row[x - 1]) && std::isfinite(row[x + 1]) &&
                                std::isfinite(tile.row(y - 1)[x]) && std::isfinite(tile.row(y + 1)[x]);
        ASSERT_TRUE(!surrounded || std::isfinite(depth)) << x << ", " << y;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, DepthRenderer,
                         testing::Values<int64_t>(HWY_SSE4, HWY_AVX2, HWY_AVX3, HWY_BASELINE_TARGETS),
                         [](const auto& target) { return std::string("target_") + std::to_string(target.index); });

TEST(RenderedDepth, GridPointsAreImagePixels) {
  const CameraModel camera = Camera();
  for (const int step : {1, 2, 3, 5, 8}) {
    const PixelGrid grid = SampledGrid(camera, step);
    const Vector3 p(0.1, -0.05, 0.8);
    const auto pixel = camera.Project(p);
    EXPECT_NEAR(grid.fx * p.x() / p.z() + grid.cx, pixel.x() / step, 1e-9);
    EXPECT_LT(grid.ImageX(grid.width - 1), camera.width);
    EXPECT_GE(grid.ImageX(grid.width), camera.width);
    EXPECT_LT(grid.ImageY(grid.height - 1), camera.height);
    EXPECT_GE(grid.ImageY(grid.height), camera.height);
  }
}

TEST(RenderedDepth, OutOfSightIsEmpty) {
  const RenderMesh mesh(BoxMesh({0.1, 0.1, 0.1}));
  const PixelGrid grid = SampledGrid(Camera(), 2);
  RenderedDepth tile;
  Pose behind = Pose::Identity();
  behind.translation().z() = -1;
  RenderDepth(mesh, grid, behind, tile);
  EXPECT_TRUE(tile.area.empty());
  Pose beside = Pose::Identity();
  beside.translation() << 3, 0, 1;
  RenderDepth(mesh, grid, beside, tile);
  EXPECT_TRUE(tile.area.empty());
  Pose broken = Pose::Identity();
  broken.translation() << std::nan(""), 0, 1;
  RenderDepth(mesh, grid, broken, {0, 0, 10, 10}, tile);
  for (int j = 0; j < 10; ++j) EXPECT_TRUE(std::isinf(tile.row(j)[5]));
}

TEST(RenderedDepth, MergeKeepsTheNearer) {
  RenderedDepth a, b;
  a.Reset({10, 10, 40, 20}, 1.0F);
  b.Reset({30, 5, 40, 10}, 0.5F);
  b.row(7)[3] = 2.0F;  // grid point 33, 12
  MergeNearer(b, a);
  for (int j = 0; j < 20; ++j) {
    for (int i = 0; i < 40; ++i) {
      const bool overlap = 10 + i >= 30 && 10 + j < 15;
      const bool exception = 10 + i == 33 && 10 + j == 12;
      ASSERT_EQ(a.row(j)[i], overlap && !exception ? 0.5F : 1.0F) << i << ", " << j;
    }
  }
  RenderedDepth apart;
  apart.Reset({200, 200, 5, 5}, 0.1F);
  const auto before = a.depth;
  MergeNearer(apart, a);
  EXPECT_EQ(a.depth, before);
}

TEST(RenderedDepth, UsedAgainAllocatesNothing) {
  RenderedDepth tile;
  tile.Reset({0, 0, 100, 100});
  const float* memory = tile.depth.data();
  tile.Reset({5, 5, 64, 90});
  EXPECT_EQ(tile.depth.data(), memory);
  EXPECT_TRUE(std::isinf(tile.row(89)[63]));
}

}  // namespace
}  // namespace coach
