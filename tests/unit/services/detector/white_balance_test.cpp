#include "services/detector/white_balance.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "services/detector/hsv_detector.h"

namespace coach {
namespace {

/// A wooden table, a blue and a red part, noise; seen with gains on blue and red.
cv::Mat Picture(double blue, double red, double brightness = 1) {
  cv::Mat image(480, 640, CV_8UC3, cv::Scalar(100, 130, 155)), noise(480, 640, CV_16SC3), wide;
  cv::rectangle(image, {100, 100, 120, 60}, cv::Scalar(140, 70, 30), cv::FILLED);
  cv::rectangle(image, {400, 300, 90, 90}, cv::Scalar(30, 30, 160), cv::FILLED);
  cv::theRNG().state = 3;
  cv::randn(noise, 0, 4);
  image.convertTo(wide, CV_16SC3);
  wide += noise;
  cv::multiply(wide, cv::Scalar(blue * brightness, brightness, red * brightness), wide);
  wide.convertTo(image, CV_8UC3);
  return image;
}

TEST(WhiteBalance, SeesTheGainsOfTheCamera) {
  const auto reference = BackgroundChromaticity(Picture(1, 1));
  ASSERT_TRUE(reference);
  EXPECT_NEAR(reference->blue_green, std::log(100 / 130.0), 0.01);
  EXPECT_NEAR(reference->red_green, std::log(155 / 130.0), 0.01);
  for (const auto& [blue, red] : {std::pair{0.8, 1.2}, {1.25, 0.85}, {1.0, 1.1}}) {
    for (const double brightness : {0.6, 1.0, 1.2}) {
      const auto seen = BackgroundChromaticity(Picture(blue, red, brightness));
      ASSERT_TRUE(seen);
      const ChannelGains gains = BalancingGains(*reference, *seen);
      EXPECT_NEAR(gains[0], 1 / blue, 0.02);
      EXPECT_EQ(gains[1], 1);
      EXPECT_NEAR(gains[2], 1 / red, 0.02);
    }
  }
}

TEST(WhiteBalance, PartsKeepTheirClassWhenTheCameraDrifts) {
  Task task;
  task.types.resize(1);
  task.types[0].hsv = {{105, 182, 40}, {114, 255, 255}};
  HsvDetectorOptions options;
  HsvDetector plain(task, options);
  options.background = BackgroundChromaticity(Picture(1, 1));
  HsvDetector balanced(task, options);
  const cv::Mat drifted = Picture(0.82, 1.25);
  const auto area = [](const Detections& d) { return d.regions.empty() ? 0 : d.regions[0].area; };
  EXPECT_GT(area(plain.Detect(Picture(1, 1), {}, 0.001)), 6300) << "the range fits what it was chosen on";
  EXPECT_LT(area(plain.Detect(drifted, {}, 0.001)), 4000);
  EXPECT_GT(area(balanced.Detect(drifted, {}, 0.001)), 6300);
}

TEST(WhiteBalance, NoBackgroundNoGains) {
  EXPECT_FALSE(BackgroundChromaticity(cv::Mat(480, 640, CV_8UC3, cv::Scalar(5, 5, 5)))) << "dark";
  EXPECT_FALSE(BackgroundChromaticity(cv::Mat(480, 640, CV_8UC3, cv::Scalar(255, 255, 255)))) << "saturated";
  EXPECT_FALSE(BackgroundChromaticity(cv::Mat(3, 3, CV_8UC3, cv::Scalar(100, 100, 100)))) << "no pixel looked at";
  EXPECT_EQ(BalancingGains({0, 0}, {0.5, 0}), (ChannelGains{1, 1, 1})) << "a hand before the camera";
}

}  // namespace
}  // namespace coach
