#include "tools/operator/outline.h"

#include <gtest/gtest.h>

namespace coach {
namespace {

const CameraModel kCamera{640, 480, 500, 500, 320, 240, {}};

TriangleMesh Box(const Vector3& low, const Vector3& high) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) {
    mesh.vertices.emplace_back(k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(), k & 4 ? high.z() : low.z());
  }
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Absolute area by the shoelace formula.
double Area(const Polygon& polygon) {
  double sum = 0;
  for (size_t k = 0; k < polygon.size(); ++k) {
    const auto& p = polygon[k];
    const auto& q = polygon[(k + 1) % polygon.size()];
    sum += static_cast<double>(p.x()) * q.y() - static_cast<double>(q.x()) * p.y();
  }
  return std::abs(sum) / 2;
}

TEST(Silhouette, ABoxSeenStraightIsItsFrontFace) {
  const TriangleMesh box = Box({-0.1, -0.05, 0}, {0.1, 0.05, 0.02});
  const Pose X_CP = MakePose(Matrix3::Identity(), Vector3(0, 0, 1));
  const auto outlines = Silhouette(box, X_CP, kCamera);
  ASSERT_EQ(outlines.size(), 1u);
  Eigen::Vector2f low(1e9f, 1e9f), high(-1e9f, -1e9f);
  for (const auto& p : outlines[0]) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  EXPECT_NEAR(low.x(), 270, 1);
  EXPECT_NEAR(high.x(), 370, 1);
  EXPECT_NEAR(low.y(), 215, 1);
  EXPECT_NEAR(high.y(), 265, 1);
  EXPECT_NEAR(Area(outlines[0]), 100 * 50, 200);
}

TEST(Silhouette, AFrameHasAHole) {
  TriangleMesh frame;
  for (const auto& bar : {Box({-0.1, -0.1, 0}, {0.1, -0.06, 0.02}), Box({-0.1, 0.06, 0}, {0.1, 0.1, 0.02}),
                          Box({-0.1, -0.1, 0}, {-0.06, 0.1, 0.02}), Box({0.06, -0.1, 0}, {0.1, 0.1, 0.02})}) {
    const int base = static_cast<int>(frame.vertices.size());
    frame.vertices.insert(frame.vertices.end(), bar.vertices.begin(), bar.vertices.end());
    for (const auto& t : bar.triangles) frame.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  const auto outlines = Silhouette(frame, MakePose(Matrix3::Identity(), Vector3(0, 0, 1)), kCamera);
  ASSERT_EQ(outlines.size(), 2u);
  EXPECT_NEAR(Area(outlines[0]), 100 * 100, 400);
  EXPECT_NEAR(Area(outlines[1]), 60 * 60, 400);
}

TEST(Silhouette, WhatIsOutsideOrBehindTheCameraIsNotDrawn) {
  const TriangleMesh box = Box({-0.1, -0.05, 0}, {0.1, 0.05, 0.02});
  EXPECT_TRUE(Silhouette(box, MakePose(Matrix3::Identity(), Vector3(5, 0, 1)), kCamera).empty());
  EXPECT_TRUE(Silhouette(box, MakePose(Matrix3::Identity(), Vector3(0, 0, -1)), kCamera).empty());
  EXPECT_TRUE(Silhouette(box, MakePose(Matrix3::Identity(), Vector3(0, 0, 0.01)), kCamera).empty());
  EXPECT_TRUE(Silhouette({}, Pose::Identity(), kCamera).empty());
}

TEST(Silhouette, IsCutAtTheImagesBorder) {
  const TriangleMesh box = Box({-0.1, -0.05, 0}, {0.1, 0.05, 0.02});
  const auto outlines = Silhouette(box, MakePose(Matrix3::Identity(), Vector3(0.64, 0, 1)), kCamera);
  ASSERT_EQ(outlines.size(), 1u);
  for (const auto& p : outlines[0]) EXPECT_LT(p.x(), 640);
  EXPECT_NEAR(Area(outlines[0]), 50 * 50, 200);
}

TEST(SilhouetteFromAbove, KeepsMetresAndPlace) {
  const TriangleMesh box = Box({0, 0, 0}, {0.18, 0.03, 0.03});
  const auto outlines = SilhouetteFromAbove(box, MakePose(Matrix3::Identity(), Vector3(1, 2, 3)), 0.0005);
  ASSERT_EQ(outlines.size(), 1u);
  EXPECT_NEAR(Area(outlines[0]), 0.18 * 0.03, 0.18 * 0.001);
  for (const auto& p : outlines[0]) {
    EXPECT_GT(p.x(), 0.999);
    EXPECT_LT(p.x(), 1.181);
    EXPECT_GT(p.y(), 1.999);
    EXPECT_LT(p.y(), 2.031);
  }
}

TEST(Simplified, AMillionTrianglesBecomeFewAndKeepTheirShape) {
  TriangleMesh bowl;  // a wavy sheet of 1000 x 500 squares
  constexpr int kColumns = 1001, kRows = 501;
  for (int y = 0; y < kRows; ++y) {
    for (int x = 0; x < kColumns; ++x) bowl.vertices.emplace_back(x * 0.0002, y * 0.0002, 0.01 * std::sin(x * 0.01));
  }
  for (int y = 0; y + 1 < kRows; ++y) {
    for (int x = 0; x + 1 < kColumns; ++x) {
      const int at = y * kColumns + x;
      bowl.triangles.push_back({at, at + 1, at + kColumns});
      bowl.triangles.push_back({at + 1, at + kColumns + 1, at + kColumns});
    }
  }
  ASSERT_EQ(bowl.triangles.size(), 1'000'000u);
  const TriangleMesh simple = Simplified(bowl, 3000);
  EXPECT_LE(simple.triangles.size(), 3000u);
  EXPECT_GT(simple.triangles.size(), 500u);
  EXPECT_NEAR((Extent(simple).high - Extent(bowl).high).norm(), 0, 0.01);
  EXPECT_EQ(Simplified(simple, 3000).triangles, simple.triangles) << "a small mesh is left alone";
}

}  // namespace
}  // namespace coach
