#include "tools/simulator/ray_tracer.h"

#include <gmock/gmock.h>

#include "tools/simulator/shapes.h"

namespace coach {
namespace {

CameraModel Camera() {
  CameraModel camera;
  camera.width = 64;
  camera.height = 48;
  camera.fx = camera.fy = 60;
  camera.cx = 31.5;
  camera.cy = 23.5;
  return camera;
}

TEST(RayTracerTest, DepthAndNormalOfAFacingBox) {
  RayTracer tracer;
  const int body = tracer.AddBody(tracer.AddMesh(MakeBox({0.2, 0.2, 0.2})));
  tracer.SetPose(body, MakePose(Matrix3::Identity(), {0, 0, 1}));
  const int wall = tracer.AddFixture(MakeBox({4, 4, 0.2}), MakePose(Matrix3::Identity(), {0, 0, 2.1}));
  tracer.Commit();
  Hits hits;
  tracer.Trace(Camera(), Pose::Identity(), &hits);
  const size_t middle = 24 * 64 + 32, corner = 0;
  EXPECT_EQ(hits.body[middle], body);
  EXPECT_NEAR(hits.z[middle], 0.9, 1e-5);
  EXPECT_NEAR(hits.normal_z[middle], -1, 1e-5);
  EXPECT_EQ(hits.body[corner], wall);
  EXPECT_NEAR(hits.z[corner], 2.0, 1e-5);  // along the axis, not along the ray
}

TEST(RayTracerTest, MovingABodyMovesItsPixels) {
  RayTracer tracer;
  const int body = tracer.AddBody(tracer.AddMesh(MakeBall(0.1)));
  Hits hits;
  for (const double x : {-0.2, 0.2}) {
    tracer.SetPose(body, MakePose(Matrix3::Identity(), {x, 0, 1}));
    tracer.Commit();
    tracer.Trace(Camera(), Pose::Identity(), &hits);
    double mean = 0, count = 0;
    for (size_t k = 0; k < hits.size(); ++k) {
      if (hits.body[k] == body) mean += static_cast<double>(k % 64), ++count;
    }
    ASSERT_GT(count, 50);
    EXPECT_NEAR(mean / count, 31.5 + 60 * x, 0.5);
  }
}

TEST(RayTracerTest, LimbIsARoundedCone) {
  RayTracer tracer;
  const int limb = tracer.AddLimb();
  tracer.SetSegments(limb, {{Vector3(-0.3, 0, 1), Vector3(0.3, 0, 1), 0.05, 0.05}});
  tracer.Commit();
  const auto hit = tracer.Cast(Vector3::Zero(), Vector3::UnitZ());
  EXPECT_EQ(hit.body, limb);
  EXPECT_NEAR(hit.distance, 0.95, 1e-3);
  EXPECT_NEAR(hit.normal.z(), -1, 1e-3);
}

TEST(RayTracerTest, SilhouetteCountsWhatIsOutsideTheImage) {
  RayTracer tracer;
  const int mesh = tracer.AddMesh(MakeBox({0.2, 0.2, 0.02}));
  const auto whole = tracer.Outline(mesh, Camera(), MakePose(Matrix3::Identity(), {0, 0, 1}));
  EXPECT_EQ(whole.pixels, whole.pixels_in_image);
  EXPECT_NEAR(whole.pixels, 12 * 12, 26);  // 0.2 m at 0.99 m and 60 px
  const auto half = tracer.Outline(mesh, Camera(), MakePose(Matrix3::Identity(), {-0.525, 0, 1}));
  EXPECT_NEAR(half.pixels, whole.pixels, 26);
  EXPECT_NEAR(half.pixels_in_image, whole.pixels / 2, 14);
}

TEST(RayTracerTest, ShadowLiesUnderTheOccluder) {
  RayTracer tracer;
  tracer.AddFixture(MakeBox({4, 4, 0.2}), MakePose(Matrix3::Identity(), {0, 0, 2.1}));
  tracer.AddFixture(MakeBox({0.5, 0.5, 0.02}), MakePose(Matrix3::Identity(), {0, 0, 1.9}));
  tracer.Commit();
  Hits hits;
  tracer.Trace(Camera(), Pose::Identity(), &hits);
  std::vector<float> free;
  tracer.Light(Camera(), Pose::Identity(), hits, {1.0, 0, 0}, 0.0, &free);
  // The board's shadow falls to its left: the wall just left of it is dark, to its right it is lit.
  const auto at = [&](double x) { return free[static_cast<size_t>(24 * 64 + std::lround(31.5 + 60 * x / 2))]; };
  EXPECT_EQ(at(-0.30), 0);
  EXPECT_EQ(at(0.34), 1);
  EXPECT_EQ(at(-0.7), 1);
}

TEST(RayTracerTest, InsideAndOutsideOfAMesh) {
  RayTracer tracer;
  const int box = tracer.AddMesh(MakeBox({0.2, 0.1, 0.1}));
  EXPECT_TRUE(tracer.Inside(box, {0.09, 0.04, -0.04}));
  EXPECT_FALSE(tracer.Inside(box, {0.11, 0, 0}));
  EXPECT_FALSE(tracer.Inside(box, {0, 0, -0.06}));
  // Points outside whose rays graze an edge.
  for (double x = -0.3; x < 0.3; x += 1e-4) {
    EXPECT_FALSE(tracer.Inside(box, {x, 0.0502, 0.01}));
    EXPECT_FALSE(tracer.Inside(box, {x, 0.01, -0.0502}));
  }
}

}  // namespace
}  // namespace coach
