// The table: its plane, its frame, its area.
#include <gtest/gtest.h>

#include "services/pose_filter/table_area.h"
#include "services/pose_filter/table_plane.h"
#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

/// Unit normal towards the camera, tilted from the optical axis by up to 65 degrees.
Plane RandomPlane(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const double tilt = 65 * kDegree * uniform(generator), around = 2 * std::numbers::pi * uniform(generator);
  const Vector3 n(std::sin(tilt) * std::cos(around), std::sin(tilt) * std::sin(around), -std::cos(tilt));
  const double along_axis = 0.5 + 0.7 * uniform(generator);
  return {n, -along_axis * n.z()};
}

/// Readings of a plane with the sensor's noise; a share of the image is covered by blocks in front, a tenth is missing.
cv::Mat DrawPlane(const Plane& plane, std::mt19937_64& generator, double clutter) {
  const CameraModel camera = TestCamera();
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  cv::Mat depth(480, 640, CV_16UC1, cv::Scalar(0));
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const double along = plane.n.dot(Vector3((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1));
      const double z = -plane.d / along;
      if (along > -0.05 || z > 6 || uniform(generator) < 0.1) continue;
      depth.at<uint16_t>(y, x) =
          static_cast<uint16_t>(std::lround(1000 * (z + (0.001 + 1.4247e-3 * z * z) * normal(generator))));
    }
  }
  for (double covered = 0; covered < clutter;) {
    const int w = 40 + static_cast<int>(80 * uniform(generator)), h = 40 + static_cast<int>(80 * uniform(generator));
    const int x = static_cast<int>(uniform(generator) * (640 - w)),
              y = static_cast<int>(uniform(generator) * (480 - h));
    const double z = -plane.d / plane.n.z();
    depth(cv::Rect(x, y, w, h)).setTo(1000 * z * (0.6 + 0.3 * uniform(generator)));
    covered += w * h / (640.0 * 480.0);
  }
  return depth;
}

Observation View(const cv::Mat& depth) {
  Observation o;
  o.camera = TestCamera();
  o.depth = depth.ptr<uint16_t>();
  return o;
}

void ExpectPlane(const Plane& found, const Plane& truth, int k) {
  EXPECT_LT(std::acos(std::min(1.0, found.n.dot(truth.n))), 0.2 * kDegree) << k;
  // Where the camera looks at it.
  EXPECT_LT(std::abs(found.Height({0, 0, -truth.d / truth.n.z()})), 0.001) << k;
}

// 4,000 readings of at most 4 mm noise: 0.06 mm at the middle; with a spread of 0.2 m or more 0.02 degrees.
TEST(FindTable, PlanesOfAnyTiltInNoiseAndClutter) {
  std::mt19937_64 generator(5);
  for (int k = 0; k < 25; ++k) {
    const Plane truth = RandomPlane(generator);
    const cv::Mat depth = DrawPlane(truth, generator, 0.25);
    const auto fit = FindTable(View(depth), static_cast<uint64_t>(k));
    ASSERT_TRUE(fit) << k;
    ExpectPlane(fit->plane, truth, k);
    EXPECT_NEAR(fit->plane.n.norm(), 1, 1e-9);
    EXPECT_GT(fit->plane.d, 0);
    EXPECT_LE(fit->inliers, fit->samples);
    // Median of |N(0, s)| is 0.67 s; s is between 1 and 5 mm.
    EXPECT_LT(fit->residual, 0.005);
    EXPECT_GT(fit->residual, 0.0003);
  }
}

TEST(FindTable, SameSeedSamePlane) {
  std::mt19937_64 generator(6);
  const cv::Mat depth = DrawPlane(RandomPlane(generator), generator, 0.2);
  const auto a = FindTable(View(depth), 3), b = FindTable(View(depth), 3);
  ASSERT_TRUE(a && b);
  EXPECT_TRUE(a->plane.n == b->plane.n && a->plane.d == b->plane.d);
}

TEST(FindTable, NoneWhereThereIsNone) {
  EXPECT_FALSE(FindTable(View(cv::Mat(480, 640, CV_16UC1, cv::Scalar(0))), 1));
  Observation nothing;
  nothing.camera = TestCamera();
  EXPECT_FALSE(FindTable(nothing, 1));
  // Readings anywhere between 0.3 and 3 m lie on no plane.
  std::mt19937_64 generator(7);
  cv::Mat chaos(480, 640, CV_16UC1);
  for (int i = 0; i < 480 * 640; ++i) chaos.ptr<uint16_t>()[i] = static_cast<uint16_t>(300 + generator() % 2700);
  EXPECT_FALSE(FindTable(View(chaos), 1));
}

TEST(RefineTable, PullsANearPlaneOntoTheTable) {
  std::mt19937_64 generator(8);
  for (int k = 0; k < 10; ++k) {
    const Plane truth = RandomPlane(generator);
    const cv::Mat depth = DrawPlane(truth, generator, 0.25);
    Plane prior{ExpRotation(RandomVector(generator, 0.5 * kDegree)) * truth.n, truth.d + 0.003};
    const auto fit = RefineTable(View(depth), prior);
    ASSERT_TRUE(fit) << k;
    ExpectPlane(fit->plane, truth, k);
    prior.d += 0.3;
    prior.n = -prior.n;
    EXPECT_FALSE(RefineTable(View(cv::Mat(480, 640, CV_16UC1, cv::Scalar(0))), prior));
  }
}

TEST(TableFrame, ZUpAndTheOriginOnTheCamerasAxis) {
  std::mt19937_64 generator(9);
  for (int k = 0; k < 100; ++k) {
    const Plane plane = RandomPlane(generator);
    const Pose X_TC = TableFrame(plane);
    EXPECT_LT((X_TC.linear() * plane.n - Vector3::UnitZ()).norm(), 1e-12);
    EXPECT_NEAR(X_TC.linear().determinant(), 1, 1e-12);
    EXPECT_LT((X_TC.linear() * X_TC.linear().transpose() - Matrix3::Identity()).norm(), 1e-12);
    // The axis' point on the table is the origin.
    EXPECT_LT((X_TC * Vector3(0, 0, -plane.d / plane.n.z())).norm(), 1e-12);
    EXPECT_NEAR((X_TC * Vector3::Zero()).z(), plane.d, 1e-12) << "the camera is above";
    // x is the camera's x, projected: no y component.
    EXPECT_NEAR((X_TC.linear() * Vector3::UnitX()).y(), 0, 1e-12);
    EXPECT_GT((X_TC.linear() * Vector3::UnitX()).x(), 0);
    const Plane back = PlaneOf(X_TC);
    EXPECT_LT((back.n - plane.n).norm() + std::abs(back.d - plane.d), 1e-12);
  }
  // The camera's axis never meets the table: the foot point.
  const Plane level{Vector3(0, -1, 0), 0.4};
  EXPECT_LT((TableFrame(level) * Vector3(0, 0.4, 0)).norm(), 1e-12);
}

TEST(TableArea, ReachesAsFarAsTheTable) {
  const Task task = TestTask({TestType("l", LMesh(), true, 1)});
  const DrawnObservation drawn(task, DrawScene(task, {OnTable(0, 0, 0)}, 1));
  TableArea area;
  EXPECT_TRUE(area.Over({5, 5, 0})) << "nothing is known yet";
  area.Add(drawn.View(), TestTable().inverse());
  EXPECT_TRUE(area.Over({0, 0, 0}));
  EXPECT_TRUE(area.Over({0.25, 0.2, 0.1}));
  EXPECT_TRUE(area.Over({0, 0.45, 0})) << "the table ends at 0.4 m; 15 cm more count";
  EXPECT_FALSE(area.Over({0, 0.70, 0}));
  EXPECT_FALSE(area.Over({1.5, 0, 0}));
  EXPECT_FALSE(area.Over({100, -100, 0}));
  area.Reset();
  EXPECT_TRUE(area.Over({1.5, 0, 0}));
}

TEST(TableArea, AStripFarFromTheTableIsNone) {
  // A table of 0.5 m and, 0.9 m farther along the same plane, a thin line: a wall's foot.
  const Pose X_CT = TestTable();
  Observation o;
  o.camera = TestCamera();
  o.has_table = true;
  o.table = PlaneOf(X_CT.inverse());
  cv::Mat depth(480, 640, CV_16UC1, cv::Scalar(0));
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      const Vector3 ray((x - 320) / 570.0, (y - 240) / 570.0, 1);
      const double z = -o.table.d / o.table.n.dot(ray);
      const double far = (X_CT.inverse() * Vector3(z * ray)).y();
      if (z > 0 && (std::abs(far) < 0.25 || std::abs(far - 0.9) < 0.05))
        depth.at<uint16_t>(y, x) = static_cast<uint16_t>(std::lround(1000 * z));
    }
  }
  o.depth = depth.ptr<uint16_t>();
  TableArea area;
  area.Add(o, X_CT.inverse());
  EXPECT_TRUE(area.Over({0, 0.2, 0}));
  EXPECT_FALSE(area.Over({0, 0.9, 0}));
}

}  // namespace
}  // namespace coach
