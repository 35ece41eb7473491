#include "services/detector/bit_image.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace coach {
namespace {

std::vector<uint8_t> RandomClasses(int width, int height, double density, uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::bernoulli_distribution one(density);
  std::vector<uint8_t> classes(static_cast<size_t>(width * height));
  for (uint8_t& byte : classes) {
    for (int bit = 0; bit < 8; ++bit) byte |= static_cast<uint8_t>(one(generator) << bit);
  }
  return classes;
}

/// 1 inside; what is outside the image is left out of the neighbourhood.
bool SlowNeighbourhood(const BitImage& image, int x, int y, bool all) {
  for (int v = std::max(0, y - 1); v <= std::min(image.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(image.width() - 1, x + 1); ++u) {
      if (image.at(u, v) != all) return !all;
    }
  }
  return all;
}

class BitImageOfWidth : public testing::TestWithParam<int> {};

TEST_P(BitImageOfWidth, ExtractsEachBit) {
  const int width = GetParam(), height = 5;
  const auto classes = RandomClasses(width, height, 0.4, 1);
  for (int bit = 0; bit < 8; ++bit) {
    BitImage image;
    ExtractBit(classes.data(), width, height, bit, image);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        ASSERT_EQ(image.at(x, y), classes[static_cast<size_t>(y * width + x)] >> bit & 1) << x << ", " << y;
      }
    }
  }
}

TEST_P(BitImageOfWidth, MorphologyIsThatOfTheDefinition) {
  const int width = GetParam(), height = 9;
  for (const double density : {0.1, 0.5, 0.9}) {
    BitImage image, dilated, eroded;
    ExtractBit(RandomClasses(width, height, density, 2).data(), width, height, 3, image);
    Dilate(image, dilated);
    Erode(image, eroded);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        ASSERT_EQ(dilated.at(x, y), SlowNeighbourhood(image, x, y, false)) << x << ", " << y;
        ASSERT_EQ(eroded.at(x, y), SlowNeighbourhood(image, x, y, true)) << x << ", " << y;
      }
    }
  }
}

TEST_P(BitImageOfWidth, RunsAreThePixels) {
  const int width = GetParam(), height = 4;
  for (const double density : {0.0, 0.3, 0.97, 1.0}) {
    BitImage image;
    ExtractBit(RandomClasses(width, height, density, 4).data(), width, height, 0, image);
    for (int y = 0; y < height; ++y) {
      std::string drawn(static_cast<size_t>(width), '0'), expected = drawn;
      int last_end = -1;
      ForEachRun(image, y, [&](int begin, int end) {
        EXPECT_GT(begin, last_end) << "runs are apart and in order";
        ASSERT_GT(end, begin);
        ASSERT_LE(end, width);
        last_end = end;
        for (int x = begin; x < end; ++x) drawn[static_cast<size_t>(x)] = '1';
      });
      for (int x = 0; x < width; ++x) expected[static_cast<size_t>(x)] = image.at(x, y) ? '1' : '0';
      EXPECT_EQ(drawn, expected);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Widths, BitImageOfWidth, testing::Values(1, 7, 8, 63, 64, 65, 127, 128, 200));

TEST(BitImage, OpeningRemovesSpecklesAndKeepsBlocks) {
  std::vector<uint8_t> classes(20 * 20, 0);
  classes[3 * 20 + 15] = 1;
  for (int y = 8; y < 14; ++y) {
    for (int x = 2; x < 9; ++x) classes[static_cast<size_t>(y * 20 + x)] = 1;
  }
  BitImage image, scratch;
  ExtractBit(classes.data(), 20, 20, 0, image);
  Open(1, image, scratch);
  EXPECT_FALSE(image.at(15, 3));
  int area = 0;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) area += image.at(x, y);
  }
  EXPECT_EQ(area, 6 * 7);
}

TEST(BitImage, ClosingBridgesAGap) {
  std::vector<uint8_t> classes(20 * 8, 1);
  for (int y = 0; y < 8; ++y) classes[static_cast<size_t>(y * 20 + 10)] = classes[static_cast<size_t>(y * 20 + 11)] = 0;
  BitImage image, scratch;
  ExtractBit(classes.data(), 20, 8, 0, image);
  Close(1, image, scratch);
  for (int y = 0; y < 8; ++y) EXPECT_TRUE(image.at(10, y) && image.at(11, y));
}

}  // namespace
}  // namespace coach
