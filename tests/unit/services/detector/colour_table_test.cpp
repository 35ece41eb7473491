#include "services/detector/colour_table.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

namespace coach {
namespace {

std::array<int, 3> Hsv(int b, int g, int r) {
  cv::Mat bgr(1, 1, CV_8UC3, cv::Scalar(b, g, r)), hsv;
  cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV);
  const auto p = hsv.at<cv::Vec3b>(0, 0);
  return {p[0], p[1], p[2]};
}

const std::vector<HsvRange> kRanges{{{105, 148, 40}, {117, 254, 176}}, {{165, 80, 60}, {25, 255, 255}}};

TEST(ColourTable, RangeWrapsThroughRed) {
  EXPECT_TRUE(Contains(kRanges[1], 170, 200, 200));
  EXPECT_TRUE(Contains(kRanges[1], 25, 200, 200));
  EXPECT_FALSE(Contains(kRanges[1], 26, 200, 200));
  EXPECT_FALSE(Contains(kRanges[1], 164, 200, 200));
  EXPECT_FALSE(Contains(kRanges[1], 170, 79, 200));
  EXPECT_TRUE(Contains(kRanges[0], 105, 148, 176));
  EXPECT_FALSE(Contains(kRanges[0], 105, 148, 177));
}

// The documented tolerance: where the table disagrees with exact conversion, a colour of the same cell has the other
// answer.
TEST(ColourTable, DiffersFromExactConversionOnlyBesideABoundary) {
  const ColourTable table(kRanges);
  std::mt19937_64 generator(7);
  std::uniform_int_distribution<int> level(0, 255);
  int different = 0;
  for (int i = 0; i < 20000; ++i) {
    const int b = level(generator), g = level(generator), r = level(generator);
    const uint8_t classes = table.Classify(b, g, r);
    const auto hsv = Hsv(b, g, r);
    for (size_t c = 0; c < kRanges.size(); ++c) {
      const bool exact = Contains(kRanges[c], hsv[0], hsv[1], hsv[2]);
      if (exact == (classes >> c & 1)) continue;
      ++different;
      bool other = false;
      for (int k = 0; k < 64 && !other; ++k) {
        const auto near = Hsv((b & ~3) + k % 4, (g & ~3) + k / 4 % 4, (r & ~3) + k / 16);
        other = Contains(kRanges[c], near[0], near[1], near[2]) != exact;
      }
      EXPECT_TRUE(other) << b << " " << g << " " << r;
    }
  }
  EXPECT_LT(different, 20000 * 0.02);
}

TEST(ColourTable, GainsActBeforeTheLookUp) {
  const ColourTable table(kRanges);
  const cv::Mat warm(1, 1, CV_8UC3, cv::Scalar(80, 70, 30));  // a blue block under a warm lamp
  uint8_t as_it_is = 0, corrected = 0;
  table.Classify(warm, {1, 1, 1}, &as_it_is);
  table.Classify(warm, {1.5F, 0.9F, 0.9F}, &corrected);
  EXPECT_EQ(as_it_is & 1, (table.Classify(80, 70, 30)) & 1);
  EXPECT_EQ(corrected, table.Classify(120, 63, 27));
  uint8_t saturated = 0;
  table.Classify(cv::Mat(1, 1, CV_8UC3, cv::Scalar(10, 10, 200)), {1, 1, 100}, &saturated);
  EXPECT_EQ(saturated, table.Classify(10, 10, 255)) << "levels stop at 255";
}

TEST(ColourTable, WholeImageIsPixelByPixel) {
  const ColourTable table(kRanges);
  std::mt19937_64 generator(2);
  for (const int width : {1, 2, 17}) {
    cv::Mat image(5, width, CV_8UC3);
    for (int y = 0; y < 5; ++y) {
      for (int i = 0; i < 3 * width; ++i) image.ptr<uint8_t>(y)[i] = static_cast<uint8_t>(generator());
    }
    std::vector<uint8_t> plain(image.total()), with_gains(image.total());
    table.Classify(image, {1, 1, 1}, plain.data());
    table.Classify(image, {1.0001F, 1, 1}, with_gains.data());
    EXPECT_EQ(plain, with_gains);
    for (int i = 0; i < 5 * width; ++i) {
      const auto p = image.at<cv::Vec3b>(i / width, i % width);
      ASSERT_EQ(plain[static_cast<size_t>(i)], table.Classify(p[0], p[1], p[2]));
    }
  }
}

TEST(ColourTable, RefusesWhatItCannotHold) {
  EXPECT_THROW(ColourTable(std::vector<HsvRange>(9)), std::invalid_argument);
  EXPECT_THROW(ColourTable({HsvRange{{0, 0, 0}, {180, 255, 255}}}), std::invalid_argument);
  EXPECT_THROW(ColourTable({HsvRange{{0, -1, 0}, {179, 255, 255}}}), std::invalid_argument);
}

}  // namespace
}  // namespace coach
