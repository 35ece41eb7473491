#include "services/detector/colour_table.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace coach {
namespace {

void Check(const HsvRange& range, size_t index) {
  constexpr std::array<int, 3> kMax{179, 255, 255};
  constexpr std::array<const char*, 3> kName{"hue", "saturation", "value"};
  for (size_t i = 0; i < 3; ++i) {
    for (const int bound : {range.low[i], range.high[i]}) {
      if (bound < 0 || bound > kMax[i]) {
        throw std::invalid_argument("colour class " + std::to_string(index) + ": " + kName[i] + " " +
                                    std::to_string(bound) + " is outside 0.." + std::to_string(kMax[i]));
      }
    }
  }
}

/// Where in the table each level of each channel leads: the gains cost nothing a pixel.
using ChannelOffsets = std::array<std::array<uint32_t, 256>, 3>;

ChannelOffsets Offsets(const ChannelGains& gains) {
  ChannelOffsets offsets;
  for (size_t channel = 0; channel < 3; ++channel) {
    for (size_t level = 0; level < 256; ++level) {
      const long corrected = std::lround(gains[channel] * static_cast<float>(level));
      offsets[channel][level] = static_cast<uint32_t>(std::clamp(corrected, 0L, 255L) >> 2) << (6 * channel);
    }
  }
  return offsets;
}

}  // namespace

bool Contains(const HsvRange& range, int hue, int saturation, int value) {
  const bool hue_inside = range.low[0] <= range.high[0] ? hue >= range.low[0] && hue <= range.high[0]
                                                        : hue >= range.low[0] || hue <= range.high[0];
  return hue_inside && saturation >= range.low[1] && saturation <= range.high[1] && value >= range.low[2] &&
         value <= range.high[2];
}

ColourTable::ColourTable(const std::vector<HsvRange>& classes) : cells_(64 * 64 * 64) {
  if (classes.size() > kMaxClasses) {
    throw std::invalid_argument("at most " + std::to_string(kMaxClasses) + " colour classes are possible, found " +
                                std::to_string(classes.size()));
  }
  for (size_t c = 0; c < classes.size(); ++c) Check(classes[c], c);
  // One slice of the cube at a time: 4 levels of red, all of green and blue.
  cv::Mat bgr(4 * 256, 256, CV_8UC3), hsv;
  std::vector<std::array<uint8_t, ColourTable::kMaxClasses>> votes(64 * 64);
  for (int red = 0; red < 64; ++red) {
    for (int row = 0; row < bgr.rows; ++row) {
      for (int blue = 0; blue < 256; ++blue) {
        bgr.at<cv::Vec3b>(row, blue) = {static_cast<uint8_t>(blue), static_cast<uint8_t>(row & 255),
                                        static_cast<uint8_t>(4 * red + (row >> 8))};
      }
    }
    cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV);
    std::fill(votes.begin(), votes.end(), std::array<uint8_t, ColourTable::kMaxClasses>{});
    for (int row = 0; row < bgr.rows; ++row) {
      for (int blue = 0; blue < 256; ++blue) {
        const cv::Vec3b& colour = hsv.at<cv::Vec3b>(row, blue);
        auto& vote = votes[static_cast<size_t>((row & 255) >> 2) * 64 + static_cast<size_t>(blue >> 2)];
        for (size_t c = 0; c < classes.size(); ++c) vote[c] += Contains(classes[c], colour[0], colour[1], colour[2]);
      }
    }
    for (size_t i = 0; i < votes.size(); ++i) {
      uint8_t set = 0;
      for (size_t c = 0; c < classes.size(); ++c) set |= static_cast<uint8_t>((votes[i][c] >= 32) << c);
      cells_[static_cast<size_t>(red) * 64 * 64 + i] = set;
    }
  }
}

void ColourTable::Classify(const cv::Mat& bgr, const ChannelGains& gains, uint8_t* classes) const {
  const bool as_they_are = gains == ChannelGains{1, 1, 1};
  const ChannelOffsets offsets = Offsets(gains);
  const auto columns = static_cast<size_t>(bgr.cols);
  for (int row = 0; row < bgr.rows; ++row) {
    const uint8_t* pixels = bgr.ptr<uint8_t>(row);
    uint8_t* out = classes + static_cast<size_t>(row) * columns;
    if (as_they_are) {
      ClassifyRow(pixels, columns, out);
    } else {
      for (size_t x = 0; x < columns; ++x, pixels += 3) {
        out[x] = cells_[offsets[0][pixels[0]] | offsets[1][pixels[1]] | offsets[2][pixels[2]]];
      }
    }
  }
}

void ColourTable::ClassifyRow(const uint8_t* pixels, size_t columns, uint8_t* out) const {
  const uint8_t* cells = cells_.data();
  size_t x = 0;
  for (; x + 1 < columns; ++x) {
    // One load of the pixel and a byte of the next; the high six bits of three bytes move together.
    uint32_t v;
    std::memcpy(&v, pixels + 3 * x, 4);
    if constexpr (std::endian::native == std::endian::big) v = __builtin_bswap32(v);
    out[x] = cells[(v >> 2 & 0x3f) | (v >> 4 & 0xfc0) | (v >> 6 & 0x3f000)];
  }
  for (; x < columns; ++x) out[x] = Classify(pixels[3 * x], pixels[3 * x + 1], pixels[3 * x + 2]);
}

}  // namespace coach
