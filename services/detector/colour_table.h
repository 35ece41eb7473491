// Which colour classes a pixel is in, by one look-up.
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/assembly/task.h"

namespace coach {

/// Factors on blue, green and red before the look-up; 1: as they are.
using ChannelGains = std::array<float, 3>;

/// Sets of colour classes over the BGR cube, one byte (bit c: in class c) for each cell of 4 x 4 x 4 levels. A cell is
/// in a class if at least half of its 64 colours are, by OpenCV's 8-bit HSV; so a pixel's answer differs from the exact
/// one only if a colour at most 3 levels away in each channel is on the other side of the range.
class ColourTable {
 public:
  static constexpr int kMaxClasses = 8;

  /// @param classes one range a class. @throws std::invalid_argument if there are more than kMaxClasses or a bound is
  /// outside OpenCV's 8-bit HSV (0..179, 0..255, 0..255).
  explicit ColourTable(const std::vector<HsvRange>& classes);

  /// Classes of one colour.
  uint8_t Classify(int blue, int green, int red) const {
    return cells_[static_cast<size_t>((blue >> 2) | (green >> 2) << 6 | (red >> 2) << 12)];
  }

  /// Classes of every pixel of a CV_8UC3 image, into rows * cols bytes.
  void Classify(const cv::Mat& bgr, const ChannelGains& gains, uint8_t* classes) const;

 private:
  void ClassifyRow(const uint8_t* pixels, size_t columns, uint8_t* out) const;

  std::vector<uint8_t> cells_;
};

/// True if an 8-bit HSV colour (OpenCV's) is in the range; hue wraps through red if the range's low hue is above its
/// high.
bool Contains(const HsvRange& range, int hue, int saturation, int value);

}  // namespace coach
