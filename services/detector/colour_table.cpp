#include "services/detector/colour_table.h"

#include <algorithm>
#include <cmath>
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
  // Where in the table each level of each channel leads: the gains cost nothing a pixel.
  std::array<std::array<uint32_t, 256>, 3> offset;
  for (size_t channel = 0; channel < 3; ++channel) {
    for (size_t level = 0; level < 256; ++level) {
      const auto corrected =
          static_cast<uint32_t>(std::clamp(std::lround(gains[channel] * static_cast<float>(level)), 0L, 255L));
      offset[channel][level] = (corrected >> 2) << (6 * channel);
    }
  }
  const uint8_t* cells = cells_.data();
  for (int row = 0; row < bgr.rows; ++row) {
    const uint8_t* pixel = bgr.ptr<uint8_t>(row);
    uint8_t* out = classes + static_cast<size_t>(row) * static_cast<size_t>(bgr.cols);
    for (int x = 0; x < bgr.cols; ++x, pixel += 3) {
      out[x] = cells[offset[0][pixel[0]] | offset[1][pixel[1]] | offset[2][pixel[2]]];
    }
  }
}

}  // namespace coach
