#include "services/detector/connected_components.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

namespace coach {
namespace {

// Against OpenCV's labelling: equal partitions, equal statistics.
TEST(ConnectedComponents, AgreesWithOpenCv) {
  ConnectedComponents ours;
  for (const int width : {1, 64, 97, 200}) {
    for (const double density : {0.05, 0.3, 0.45, 0.7, 1.0}) {
      const int height = 60;
      std::mt19937_64 generator(static_cast<uint64_t>(width));
      std::bernoulli_distribution one(density);
      cv::Mat image(height, width, CV_8UC1);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) image.at<uint8_t>(y, x) = one(generator);
      }
      BitImage bits;
      ExtractBit(image.data, width, height, 0, bits);
      ours.Find(bits);
      cv::Mat labels, stats, centroids;
      const int count = cv::connectedComponentsWithStats(image, labels, stats, centroids, 8, CV_32S);
      ASSERT_EQ(ours.components().size(), static_cast<size_t>(count - 1));
      int pixels = 0;
      for (const PixelRun& run : ours.runs()) {
        const int label = labels.at<int>(run.y, run.begin);
        ASSERT_GT(label, 0);
        const Component& c = ours.components()[static_cast<size_t>(run.component)];
        for (int x = run.begin; x < run.end; ++x, ++pixels) ASSERT_EQ(labels.at<int>(run.y, x), label);
        ASSERT_EQ(c.area, stats.at<int>(label, cv::CC_STAT_AREA));
        ASSERT_NEAR(c.centroid[0], centroids.at<double>(label, 0), 1e-9);
        ASSERT_NEAR(c.centroid[1], centroids.at<double>(label, 1), 1e-9);
        ASSERT_EQ(c.box, (std::array<int, 4>{
                             stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
                             stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT)}));
      }
      EXPECT_EQ(pixels, cv::countNonZero(image));
    }
  }
}

TEST(ConnectedComponents, SpiralIsOneRegion) {
  // Every second ring, joined: unions that arrive late.
  const char* rows[] = {"1111111", "0000001", "1111101", "1000101", "1011101", "1000001", "1111111"};
  std::vector<uint8_t> classes;
  for (const char* row : rows) {
    for (int x = 0; x < 7; ++x) classes.push_back(static_cast<uint8_t>(row[x] == '1'));
  }
  BitImage bits;
  ExtractBit(classes.data(), 7, 7, 0, bits);
  ConnectedComponents found;
  found.Find(bits);
  ASSERT_EQ(found.components().size(), 1u);
  EXPECT_EQ(found.components()[0].box, (std::array<int, 4>{0, 0, 7, 7}));
}

}  // namespace
}  // namespace coach
