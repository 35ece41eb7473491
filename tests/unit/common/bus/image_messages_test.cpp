#include "common/bus/image_messages.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

namespace coach {
namespace {

using testing::HasSubstr;

Frame MakeFrame() {
  Frame frame;
  frame.utime = 5;
  frame.received_utime = 6;
  frame.sequence = 7;
  frame.camera = {32, 24, 30.5, 31.5, 15.25, 12.75, {0.1, 0.2, 0.3, 0.4, 0.5}};
  frame.metres_per_unit = 0.001;
  frame.exposure_skew_us = -1500;
  frame.colour.create(24, 32, CV_8UC3);
  frame.depth.create(24, 32, CV_16UC1);
  cv::RNG random(1);
  random.fill(frame.colour, cv::RNG::UNIFORM, 0, 256);
  random.fill(frame.depth, cv::RNG::UNIFORM, 0, 65536);
  return frame;
}

void ExpectSameHead(const Frame& a, const Frame& b) {
  EXPECT_EQ(a.utime, b.utime);
  EXPECT_EQ(a.received_utime, b.received_utime);
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.exposure_skew_us, b.exposure_skew_us);
}

TEST(ImageMessages, ImagesComeBackWithEverythingThatGoesWithThem) {
  const Frame frame = MakeFrame();
  const Frame colour = FromMessage(ToColourMessage(frame, ColourEncoding::kRgb8, 95));
  ExpectSameHead(frame, colour);
  EXPECT_EQ(cv::norm(frame.colour, colour.colour, cv::NORM_INF), 0);
  EXPECT_TRUE(colour.depth.empty());
  for (const DepthEncoding encoding : {DepthEncoding::kZstd, DepthEncoding::kRaw16}) {
    const Frame depth = FromMessage(ToDepthMessage(frame, encoding));
    ExpectSameHead(frame, depth);
    EXPECT_EQ(depth.metres_per_unit, 0.001);  // exactly, though it travels as a float
    EXPECT_EQ(cv::norm(frame.depth, depth.depth, cv::NORM_INF), 0);
    EXPECT_TRUE(depth.colour.empty());
  }
}

template <class M>
std::string Refusal(M message, void (*spoil)(M&)) {
  spoil(message);
  try {
    FromMessage(message);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

TEST(ImageMessages, WhatIsNoImageIsRefused) {
  const color_image_t colour = ToColourMessage(MakeFrame(), ColourEncoding::kJpeg, 90);
  const depth_image_t depth = ToDepthMessage(MakeFrame(), DepthEncoding::kZstd);
  EXPECT_THAT(Refusal<color_image_t>(colour, [](auto& m) { m.intrinsics.width = 20000; }),
              HasSubstr("intrinsics.width"));
  EXPECT_THAT(Refusal<color_image_t>(colour, [](auto& m) { m.intrinsics.width = 33; }), HasSubstr("33 x 24"));
  EXPECT_THAT(Refusal<color_image_t>(colour, [](auto& m) { m.intrinsics.fx = NAN; }), HasSubstr("intrinsics"));
  EXPECT_THAT(Refusal<color_image_t>(colour, [](auto& m) { m.encoding = 2; }), HasSubstr("encoding"));
  EXPECT_THAT(Refusal<color_image_t>(colour, [](auto& m) { m.data_size = 3; }), HasSubstr("data_size"));
  EXPECT_THAT(Refusal<depth_image_t>(depth, [](auto& m) { m.metres_per_unit = 0; }), HasSubstr("metres_per_unit"));
  EXPECT_THAT(Refusal<depth_image_t>(depth, [](auto& m) { m.encoding = -1; }), HasSubstr("encoding"));
  EXPECT_THAT(Refusal<depth_image_t>(depth, [](auto& m) { m.data[0] ^= 0xff; }), HasSubstr("zstd"));
}

TEST(ImageMessages, AnImageOfAnotherSizeThanItsCameraIsNotSent) {
  Frame frame = MakeFrame();
  frame.camera.width = 31;
  EXPECT_THROW(ToColourMessage(frame, ColourEncoding::kJpeg, 90), std::invalid_argument);
  EXPECT_THROW(ToDepthMessage(frame, DepthEncoding::kZstd), std::invalid_argument);
}

}  // namespace
}  // namespace coach
