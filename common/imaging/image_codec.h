// Images as bytes on the bus. Every decoder checks what it reads against the size it is told before it allocates.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <span>
#include <vector>

namespace coach {

/// Largest width and height an image may have, px.
constexpr int kMaxImageSide = 4096;

enum class ColourEncoding {
  kJpeg = 0,  ///< JPEG without chroma subsampling (4:4:4)
  kRgb8 = 1,  ///< 3 bytes a pixel: red, green, blue; rows without padding
};
enum class DepthEncoding {
  kZstd = 0,   ///< kRaw16 compressed by zstd; lossless
  kRaw16 = 1,  ///< 2 bytes a pixel, little endian; rows without padding
};

/// @param image CV_8UC3, blue green red, at most kMaxImageSide a side. @param quality 1..100, for kJpeg.
/// @throws std::invalid_argument for another image.
std::vector<uint8_t> EncodeColour(const cv::Mat& image, ColourEncoding encoding, int quality = 95);
std::vector<uint8_t> EncodeJpeg(const cv::Mat& image, int quality);

/// The image of width x height px (CV_8UC3, blue green red).
/// @throws std::invalid_argument saying why the bytes are not such an image.
cv::Mat DecodeColour(std::span<const uint8_t> bytes, ColourEncoding encoding, int width, int height);

/// @param image CV_16UC1, at most kMaxImageSide a side. @param level of zstd, 1 fast .. 19 small.
/// @throws std::invalid_argument for another image.
std::vector<uint8_t> EncodeDepth(const cv::Mat& image, DepthEncoding encoding, int level = 1);

/// The image of width x height px (CV_16UC1), exactly as it was encoded.
/// @throws std::invalid_argument saying why the bytes are not such an image.
cv::Mat DecodeDepth(std::span<const uint8_t> bytes, DepthEncoding encoding, int width, int height);

}  // namespace coach
