#include "tools/simulator/depth_sensor.h"

#include <gmock/gmock.h>

#include <set>

#include "tools/simulator/shapes.h"

namespace coach {
namespace {

CameraModel Camera() {
  CameraModel camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 262;
  camera.cx = 159.5;
  camera.cy = 119.5;
  return camera;
}

/// A wall at 1 m, a box in front of its middle at 0.8 m.
cv::Mat Picture(const DepthSensorOptions& options, std::vector<double> holes = {0, 0}) {
  RayTracer tracer;
  tracer.AddFixture(MakeBox({4, 4, 0.1}), MakePose(Matrix3::Identity(), {0, 0, 1.05}));
  tracer.AddFixture(MakeBox({0.2, 0.2, 0.02}), MakePose(Matrix3::Identity(), {0, 0, 0.81}));
  tracer.Commit();
  Random random(1);
  DepthSensor sensor(options, Camera(), random);
  Hits hits;
  tracer.Trace(sensor.camera(), sensor.X_CI(), &hits);
  return sensor.Measure(hits, sensor.X_CI().linear(), holes, random);
}

TEST(DepthSensorTest, PerfectDepthIsTheDepth) {
  const cv::Mat depth = Picture({.kind = DepthSensorOptions::Kind::kPerfect});
  EXPECT_EQ(depth.at<uint16_t>(120, 160), 800);
  EXPECT_EQ(depth.at<uint16_t>(20, 20), 1000);
}

TEST(DepthSensorTest, StructuredLightIsQuantisedInDisparity) {
  const cv::Mat depth = Picture({});
  std::set<int> levels;
  double sum = 0, squares = 0, n = 0;
  for (int y = 160; y < 230; ++y) {
    for (int x = 60; x < 260; ++x) {
      const int z = depth.at<uint16_t>(y, x);
      if (z < 950 || z > 1050) continue;
      levels.insert(z);
      sum += z, squares += z * z, ++n;
    }
  }
  ASSERT_GT(n, 0.9 * 70 * 200);
  // fx 290 px at 320 px, baseline 75 mm: an eighth of a pixel is 5.7 mm at 1 m.
  EXPECT_LT(levels.size(), 12u);
  const double mean = sum / n, deviation = std::sqrt(squares / n - mean * mean);
  EXPECT_NEAR(mean, 1000, 1.5);
  EXPECT_GT(deviation, 2.5);
  EXPECT_LT(deviation, 8);
}

TEST(DepthSensorTest, ProjectorShadowLiesOnOneSideOfAnObject) {
  const cv::Mat depth = Picture({});
  const auto missing = [&](int from, int to) {
    int n = 0;
    for (int y = 100; y < 140; ++y) {
      for (int x = from; x < to; ++x) n += depth.at<uint16_t>(y, x) == 0;
    }
    return n / 40.0;
  };
  // The box covers 127..192. The projector stands 50 mm right of the colour camera: to the left of the box a strip of
  // 50 mm * 262 px / m * (1 / 0.8 - 1) = 3.3 px has no light; to the right 1.6 px are not seen by the infrared camera.
  const double left = missing(110, 130), right = missing(190, 210);
  EXPECT_GT(left, right + 0.8);
  EXPECT_LT(left, 8);
}

TEST(DepthSensorTest, ShinySurfacesHaveHoles) {
  const cv::Mat whole = Picture({}), shiny = Picture({}, {0, 0.4});
  int before = 0, after = 0;
  for (int y = 100; y < 140; ++y) {
    for (int x = 140; x < 180; ++x) before += whole.at<uint16_t>(y, x) > 0, after += shiny.at<uint16_t>(y, x) > 0;
  }
  EXPECT_NEAR(static_cast<double>(after) / before, 0.6, 0.15);
}

TEST(DepthSensorTest, TimeOfFlightHasNoShadowButFlyingPixels) {
  const cv::Mat depth = Picture({.kind = DepthSensorOptions::Kind::kTimeOfFlight});
  int between = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) between += depth.at<uint16_t>(y, x) > 830 && depth.at<uint16_t>(y, x) < 970;
  }
  EXPECT_GT(between, 5);
}

}  // namespace
}  // namespace coach
