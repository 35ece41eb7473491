#include "common/imaging/image_codec.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <random>

namespace coach {
namespace {

cv::Mat RandomImage(int width, int height, int type, int seed) {
  cv::Mat image(height, width, type);
  cv::RNG random(static_cast<uint64_t>(seed));
  random.fill(image, cv::RNG::UNIFORM, 0, type == CV_16UC1 ? 65536 : 256);
  return image;
}

bool Equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(DepthCodec, IsLossless) {
  for (const auto& [width, height] : {std::pair{640, 480}, {1, 1}, {33, 7}}) {
    const cv::Mat depth = RandomImage(width, height, CV_16UC1, width);
    for (const DepthEncoding encoding : {DepthEncoding::kZstd, DepthEncoding::kRaw16})
      EXPECT_TRUE(Equal(DecodeDepth(EncodeDepth(depth, encoding), encoding, width, height), depth));
  }
}

TEST(DepthCodec, TakesPartsOfLargerImages) {
  const cv::Mat depth = RandomImage(64, 48, CV_16UC1, 3)(cv::Rect(5, 6, 20, 10));
  for (const DepthEncoding encoding : {DepthEncoding::kZstd, DepthEncoding::kRaw16})
    EXPECT_TRUE(Equal(DecodeDepth(EncodeDepth(depth, encoding), encoding, 20, 10), depth));
}

TEST(DepthCodec, RefusesOtherSizesAndBrokenBytes) {
  const cv::Mat depth = RandomImage(32, 24, CV_16UC1, 4);
  for (const DepthEncoding encoding : {DepthEncoding::kZstd, DepthEncoding::kRaw16}) {
    std::vector<uint8_t> bytes = EncodeDepth(depth, encoding);
    EXPECT_THROW(DecodeDepth(bytes, encoding, 32, 25), std::invalid_argument);
    EXPECT_THROW(DecodeDepth(bytes, encoding, 32, 23), std::invalid_argument);
    EXPECT_THROW(DecodeDepth(bytes, encoding, -1, 24), std::invalid_argument);
    EXPECT_THROW(DecodeDepth(bytes, encoding, kMaxImageSide + 1, 1), std::invalid_argument);
    bytes.pop_back();
    EXPECT_THROW(DecodeDepth(bytes, encoding, 32, 24), std::invalid_argument);
    EXPECT_THROW(DecodeDepth({}, encoding, 32, 24), std::invalid_argument);
  }
  EXPECT_THROW(DecodeDepth(EncodeDepth(depth, DepthEncoding::kRaw16), static_cast<DepthEncoding>(7), 32, 24),
               std::invalid_argument);
}

TEST(DepthCodec, FlippedBytesNeverCrash) {
  std::mt19937 random(5);
  const std::vector<uint8_t> good = EncodeDepth(cv::Mat(24, 32, CV_16UC1, cv::Scalar(800)), DepthEncoding::kZstd);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<uint8_t> bytes = good;
    bytes[random() % bytes.size()] ^= static_cast<uint8_t>(1 + random() % 255);
    try {
      EXPECT_EQ(DecodeDepth(bytes, DepthEncoding::kZstd, 32, 24).total(), 32U * 24U);
    } catch (const std::invalid_argument&) {
    }
  }
}

TEST(ColourCodec, Rgb8IsRedFirstAndLossless) {
  cv::Mat image = RandomImage(17, 9, CV_8UC3, 6);
  image.at<cv::Vec3b>(0, 0) = {1, 2, 3};  // blue, green, red
  const std::vector<uint8_t> bytes = EncodeColour(image, ColourEncoding::kRgb8);
  EXPECT_EQ(std::vector<uint8_t>(bytes.begin(), bytes.begin() + 3), (std::vector<uint8_t>{3, 2, 1}));
  EXPECT_TRUE(Equal(DecodeColour(bytes, ColourEncoding::kRgb8, 17, 9), image));
}

TEST(ColourCodec, JpegKeepsNarrowColourEdges) {
  cv::Mat image(48, 64, CV_8UC3, cv::Scalar(200, 60, 20));
  for (int x = 0; x < 64; x += 2)
    image.col(x).setTo(cv::Scalar(20, 60, 200));  // chroma subsampling would average these
  const cv::Mat back = DecodeColour(EncodeJpeg(image, 95), ColourEncoding::kJpeg, 64, 48);
  EXPECT_LT(cv::norm(image, back, cv::NORM_L1) / static_cast<double>(image.total() * 3), 8);
}

TEST(ColourCodec, LowerQualityIsSmaller) {
  const cv::Mat image = RandomImage(160, 120, CV_8UC3, 8);
  EXPECT_LT(EncodeJpeg(image, 50).size(), EncodeJpeg(image, 95).size());
  EXPECT_THROW(EncodeJpeg(image, 0), std::invalid_argument);
  EXPECT_THROW(EncodeJpeg(RandomImage(4, 4, CV_16UC1, 1), 90), std::invalid_argument);
}

TEST(ColourCodec, RefusesOtherSizesAndBrokenBytes) {
  const cv::Mat image = RandomImage(32, 24, CV_8UC3, 9);
  for (const ColourEncoding encoding : {ColourEncoding::kJpeg, ColourEncoding::kRgb8}) {
    std::vector<uint8_t> bytes = EncodeColour(image, encoding);
    EXPECT_THROW(DecodeColour(bytes, encoding, 31, 24), std::invalid_argument);
    EXPECT_THROW(DecodeColour(bytes, encoding, 32, 0), std::invalid_argument);
    bytes.resize(bytes.size() / 2);
    EXPECT_THROW(DecodeColour(bytes, encoding, 32, 24), std::invalid_argument);
    EXPECT_THROW(DecodeColour({}, encoding, 32, 24), std::invalid_argument);
  }
}

}  // namespace
}  // namespace coach
