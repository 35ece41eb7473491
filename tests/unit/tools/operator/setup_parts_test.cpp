// The computing parts of the set-up: camera check, colour calibration, robot's seat.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "services/detector/colour_table.h"
#include "services/pose_filter/table_plane.h"
#include "tools/operator/camera_check.h"
#include "tools/operator/colour_calibration.h"
#include "tools/operator/robot_seat.h"

namespace coach {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kDegree = M_PI / 180;

/// A grey table seen from `distance` (m, along the axis) with a tilt from straight down, and blocks 3 cm high on it.
class Scene {
 public:
  Scene(double distance, double tilt) {
    frame_.camera = {640, 480, 570, 570, 319.5, 239.5, {}};
    plane_.n = Vector3(0, -std::sin(tilt), -std::cos(tilt));
    plane_.d = distance * std::cos(tilt);
    frame_.colour = cv::Mat(480, 640, CV_8UC3, cv::Scalar(140, 160, 170));
    frame_.depth = cv::Mat(480, 640, CV_16UC1);
    Fill({0, 0, 640, 480}, 0);
  }
  void Block(const cv::Rect& where, const cv::Scalar& bgr) {
    cv::rectangle(frame_.colour, where, bgr, cv::FILLED);
    Fill(where, 0.03);
  }
  void Noise(double sigma) {
    std::mt19937 random(1);
    std::normal_distribution<double> noise(0, sigma);
    for (int k = 0; k < static_cast<int>(frame_.colour.total()) * 3; ++k)
      frame_.colour.data[k] = cv::saturate_cast<uint8_t>(frame_.colour.data[k] + noise(random));
  }
  Frame& frame() { return frame_; }
  const Plane& plane() const { return plane_; }

 private:
  void Fill(const cv::Rect& where, double height) {
    for (int y = where.y; y < where.br().y; ++y) {
      for (int x = where.x; x < where.br().x; ++x) {
        const Vector3 ray((x - 319.5) / 570, (y - 239.5) / 570, 1);
        const double z = (height - plane_.d) / plane_.n.dot(ray);
        frame_.depth.at<uint16_t>(y, x) = z > 0 && z < 4 ? static_cast<uint16_t>(std::lround(z * 1000)) : 0;
      }
    }
  }
  Frame frame_;
  Plane plane_;
};

TEST(CameraCheck, AGoodViewHasNoProblemsAndTrueFigures) {
  Scene scene(0.8, 35 * kDegree);
  scene.Block({300, 200, 60, 30}, {200, 60, 20});
  const CameraCheck check = CheckCamera(scene.frame());
  EXPECT_THAT(check.problems, IsEmpty());
  EXPECT_NEAR(check.distance, 0.8, 0.005);
  EXPECT_NEAR(check.tilt, 35 * kDegree, 0.5 * kDegree);
  EXPECT_NEAR(check.brightness, 170, 2);
  EXPECT_GT(check.table_share, 0.9);
}

TEST(CameraCheck, EachProblemIsNamed) {
  EXPECT_THAT(CheckCamera(Frame()).problems, ElementsAre("no_picture", "no_depth"));
  EXPECT_THAT(CheckCamera(Scene(0.3, 0.5).frame()).problems, ElementsAre("near"));
  EXPECT_THAT(CheckCamera(Scene(1.7, 0.3).frame()).problems, ElementsAre("far"));
  EXPECT_THAT(CheckCamera(Scene(0.8, 72 * kDegree).frame()).problems, Contains("flat"));
  Scene dark(0.8, 0.5), bright(0.8, 0.5), blind(0.8, 0.5);
  dark.frame().colour *= 0.1;
  EXPECT_THAT(CheckCamera(dark.frame()).problems, ElementsAre("dark"));
  bright.frame().colour.setTo(cv::Scalar::all(255));
  EXPECT_THAT(CheckCamera(bright.frame()).problems, ElementsAre("bright"));
  cv::rectangle(blind.frame().depth, {0, 0, 640, 300}, cv::Scalar(0), cv::FILLED);
  EXPECT_THAT(CheckCamera(blind.frame()).problems, ElementsAre("no_depth"));
  blind.frame().depth.release();
  EXPECT_THAT(CheckCamera(blind.frame()).problems, ElementsAre("no_depth"));
}

TEST(CameraCheck, NoiseIsNoTable) {
  Scene scene(0.8, 0.5);
  std::mt19937 random(2);
  for (auto& d : cv::Mat_<uint16_t>(scene.frame().depth)) d = static_cast<uint16_t>(500 + random() % 2000);
  EXPECT_THAT(CheckCamera(scene.frame()).problems, Contains("no_table"));
}

TEST(ColourCalibration, AClickedBlockGivesItsRangeAndOnlyIts) {
  Scene scene(0.8, 0.5);
  const cv::Rect blue(300, 200, 60, 30), green(420, 300, 40, 40);
  scene.Block(blue, {190, 80, 30});
  scene.Block(green, {50, 130, 40});
  scene.Noise(5);
  const PixelMask region = ClickedRegion(scene.frame(), scene.plane(), 330, 215);
  EXPECT_NEAR(cv::countNonZero(region), blue.area(), 0.2 * blue.area());
  EXPECT_EQ(cv::countNonZero(region(green)), 0);
  const PixelMask table = TablePixels(scene.frame(), scene.plane());
  const auto range = SuggestRange(scene.frame().colour, region, table);
  ASSERT_TRUE(range);
  EXPECT_GT(ShareIn(*range, scene.frame().colour, region), 0.98);
  EXPECT_LT(ShareIn(*range, scene.frame().colour, table), 0.005);
  EXPECT_TRUE(Contains(*range, 109, 210, 190));
  EXPECT_FALSE(Contains(*range, 60, 180, 130)) << "green";
  const auto other = SuggestRange(scene.frame().colour, ClickedRegion(scene.frame(), scene.plane(), 440, 320), table);
  ASSERT_TRUE(other);
  EXPECT_FALSE(Overlap(*range, *other));
}

TEST(ColourCalibration, RedWrapsAndWhiteHasNoHue) {
  Scene scene(0.8, 0.5);
  scene.frame().colour.setTo(cv::Scalar(40, 90, 120));
  const cv::Rect red(300, 200, 60, 30), white(420, 300, 60, 40);
  scene.Block(red, {50, 40, 200});
  scene.Block(white, {225, 230, 235});
  scene.Noise(6);
  const PixelMask table = TablePixels(scene.frame(), scene.plane());
  const auto range = SuggestRange(scene.frame().colour, ClickedRegion(scene.frame(), scene.plane(), 330, 215), table);
  ASSERT_TRUE(range);
  EXPECT_GT(range->low[0], range->high[0]);
  EXPECT_TRUE(Contains(*range, 178, 200, 200));
  EXPECT_TRUE(Contains(*range, 2, 200, 200));
  const auto pale = SuggestRange(scene.frame().colour, ClickedRegion(scene.frame(), scene.plane(), 450, 320), table);
  ASSERT_TRUE(pale);
  EXPECT_EQ(pale->low[0], 0);
  EXPECT_EQ(pale->high[0], 179);
  EXPECT_LT(pale->high[1], 100);
  EXPECT_LT(ShareIn(*pale, scene.frame().colour, table), 0.005);
}

TEST(ColourCalibration, TheTableItselfOrNothingIsNoPart) {
  Scene scene(0.8, 0.5);
  EXPECT_TRUE(ClickedRegion(scene.frame(), scene.plane(), -1, 5).empty());
  EXPECT_FALSE(SuggestRange(scene.frame().colour, PixelMask(480, 640, CV_8UC1, cv::Scalar(0)), {}));
  EXPECT_FALSE(SuggestRange(scene.frame().colour, PixelMask(), {}));
  EXPECT_EQ(ShareIn({}, scene.frame().colour, PixelMask()), 0);
}

TEST(ColourCalibration, AFittedPartsInsideLeavesItsRimOut) {
  const Polygon square{{100, 100}, {140, 100}, {140, 140}, {100, 140}};
  const PixelMask inside = InsideOf({square}, {640, 480});
  EXPECT_EQ(inside.at<uint8_t>(120, 120), 255);
  EXPECT_EQ(inside.at<uint8_t>(101, 120), 0);
  EXPECT_NEAR(cv::countNonZero(inside), 35 * 35, 80);
  EXPECT_EQ(cv::countNonZero(InsideOf({}, {640, 480})), 0);
}

TEST(ColourCalibration, RangesOverlapRoundTheCircle) {
  const HsvRange red{{170, 100, 50}, {10, 255, 255}}, orange{{8, 100, 50}, {20, 255, 255}},
      blue{{100, 100, 50}, {120, 255, 255}}, pale{{0, 0, 200}, {179, 60, 255}};
  EXPECT_TRUE(Overlap(red, orange));
  EXPECT_TRUE(Overlap(orange, red));
  EXPECT_FALSE(Overlap(red, blue));
  EXPECT_FALSE(Overlap(red, pale));
  EXPECT_TRUE(Overlap(red, red));
}

TEST(RobotSeat, IsBehindTheNearPartAndFacesTheFarOne) {
  const double yaw = -70 * kDegree;
  const Vector3 forward(std::cos(yaw), std::sin(yaw), 0), robot(0.1, 0.6, 0);
  const RobotSeat seat =
      SeatFromMarks(robot + 0.15 * forward + Vector3(0, 0, 0.015), robot + 0.40 * forward, 0.15, 0.1);
  ASSERT_EQ(seat.problem, "");
  EXPECT_NEAR((seat.X_TR.translation() - Vector3(0.1, 0.6, 0.1)).norm(), 0, 1e-9);
  EXPECT_NEAR(std::atan2(seat.X_TR(1, 0), seat.X_TR(0, 0)), yaw, 1e-9);
  EXPECT_NEAR(seat.X_TR(2, 2), 1, 1e-12);
  EXPECT_NEAR(seat.X_TR.linear().determinant(), 1, 1e-12);
  EXPECT_EQ(SeatFromMarks(robot, robot + 0.05 * forward, 0.15, 0.1).problem, "close");
}

}  // namespace
}  // namespace coach
