#include "tools/simulator/colour_ranges.h"

#include <algorithm>
#include <numeric>
#include <opencv2/imgproc.hpp>

namespace coach {
namespace {

constexpr double kTail = 0.005;  // share of the pixels that is left out at each end
constexpr int kLeastPixels = 200;

/// First and last bin between which all but the tails lie.
std::pair<int, int> Bounds(const std::vector<int>& histogram) {
  const double all = std::accumulate(histogram.begin(), histogram.end(), 0.0);
  int low = 0, high = static_cast<int>(histogram.size()) - 1;
  for (double sum = histogram[0]; low < high && sum < kTail * all;) sum += histogram[static_cast<size_t>(++low)];
  for (double sum = histogram.back(); high > low && sum < kTail * all;) sum += histogram[static_cast<size_t>(--high)];
  return {low, high};
}

/// The histogram of a circle, turned so that `first` is bin 0.
std::vector<int> Turned(const std::vector<int>& histogram, int first) {
  std::vector<int> turned(histogram);
  std::rotate(turned.begin(), turned.begin() + first, turned.end());
  return turned;
}

}  // namespace

ColourRanges::ColourRanges(const Task& task)
    : task_(task),
      hue_(task.types.size(), std::vector<int>(180)),
      saturation_(task.types.size(), std::vector<int>(256)),
      value_(task.types.size(), std::vector<int>(256)) {}

void ColourRanges::Add(const cv::Mat& colour, const cv::Mat& part_at) {
  cv::Mat hsv;
  cv::cvtColor(colour, hsv, cv::COLOR_BGR2HSV);
  for (int y = 1; y + 1 < hsv.rows; ++y) {
    for (int x = 1; x + 1 < hsv.cols; ++x) {
      const int part = part_at.at<uint8_t>(y, x) - 1;
      if (part < 0) continue;
      const auto same = [&](int dy, int dx) { return part_at.at<uint8_t>(y + dy, x + dx) == part + 1; };
      if (!same(0, -1) || !same(0, 1) || !same(-1, 0) || !same(1, 0)) continue;
      const size_t type = static_cast<size_t>(task_.parts[static_cast<size_t>(part)].type);
      const auto& pixel = hsv.at<cv::Vec3b>(y, x);
      ++hue_[type][pixel[0] % 180];
      ++saturation_[type][pixel[1]];
      ++value_[type][pixel[2]];
    }
  }
}

std::vector<HsvRange> ColourRanges::Ranges() const {
  std::vector<HsvRange> ranges;
  for (size_t type = 0; type < task_.types.size(); ++type) {
    HsvRange range = task_.types[type].hsv;
    if (std::accumulate(hue_[type].begin(), hue_[type].end(), 0) >= kLeastPixels) {
      const int peak = static_cast<int>(std::max_element(hue_[type].begin(), hue_[type].end()) - hue_[type].begin());
      const int first = (peak + 90) % 180;
      const auto [h0, h1] = Bounds(Turned(hue_[type], first));
      const auto [s0, s1] = Bounds(saturation_[type]);
      const auto [v0, v1] = Bounds(value_[type]);
      range.low = {(h0 - 3 + first + 180) % 180, std::max(0, s0 - 15), std::max(0, v0 - 15)};
      range.high = {(h1 + 3 + first) % 180, std::min(255, s1 + 15), std::min(255, v1 + 15)};
    }
    ranges.push_back(range);
  }
  return ranges;
}

}  // namespace coach
