#include "tools/operator/colour_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "services/detector/colour_table.h"

namespace coach {
namespace {

constexpr int kLeastPixels = 30;
constexpr double kOutside = 0.005;          // share of a part's pixels left out at each end
constexpr double kTableTolerance = 0.008;   // m
constexpr double kLeastHeight = 0.006;      // m, of a part's pixel above the table
constexpr int kGrey = 50;                   // median saturation below which a part has no colour of its own
constexpr double kBackgroundShare = 0.005;  // of the background that a margin may take in
constexpr std::array<int, 3> kMargin{6, 45, 45};

cv::Mat Hsv(const cv::Mat& bgr) {
  cv::Mat hsv;
  cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV);
  return hsv;
}

/// Height above the table of every pixel, m; NaN without a reading.
cv::Mat Heights(const Frame& frame, const Plane& table) {
  cv::Mat heights(frame.depth.size(), CV_32F, cv::Scalar(NAN));
  const CameraModel& c = frame.camera;
  for (int y = 0; y < frame.depth.rows; ++y) {
    for (int x = 0; x < frame.depth.cols; ++x) {
      const double z = frame.depth.at<uint16_t>(y, x) * frame.metres_per_unit;
      if (z > 0)
        heights.at<float>(y, x) = static_cast<float>(table.Height({(x - c.cx) / c.fx * z, (y - c.cy) / c.fy * z, z}));
    }
  }
  return heights;
}

int HueDistance(int a, int b) {
  const int d = std::abs(a - b);
  return std::min(d, 180 - d);
}

/// Like the clicked colour: the darker or greyer a colour, the less its hue says.
bool Like(const cv::Vec3b& seed, const cv::Vec3b& hsv) {
  const int least = std::min(seed[1], hsv[1]);
  const int hue_tolerance = least > 120 ? 9 : least > 60 ? 14 : 180;
  return HueDistance(seed[0], hsv[0]) <= hue_tolerance && std::abs(seed[1] - hsv[1]) <= 80 &&
         std::abs(seed[2] - hsv[2]) <= 90;
}

/// The middle colour of the 5 x 5 pixels about a place.
cv::Vec3b MiddleColour(const cv::Mat& bgr, int x, int y) {
  const cv::Rect around = cv::Rect(x - 2, y - 2, 5, 5) & cv::Rect({0, 0}, bgr.size());
  std::array<std::vector<uint8_t>, 3> channels;
  for (int v = around.y; v < around.br().y; ++v) {
    for (int u = around.x; u < around.br().x; ++u) {
      for (size_t k = 0; k < 3; ++k) channels[k].push_back(bgr.at<cv::Vec3b>(v, u)[static_cast<int>(k)]);
    }
  }
  cv::Mat middle(1, 1, CV_8UC3);
  for (size_t k = 0; k < 3; ++k) {
    auto& values = channels[k];
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
    middle.data[k] = values[values.size() / 2];
  }
  return Hsv(middle).at<cv::Vec3b>(0, 0);
}

struct Histograms {
  std::array<int, 180> hue{};
  std::array<int, 256> saturation{}, value{};
  int pixels = 0;
};

Histograms Count(const cv::Mat& hsv, const PixelMask& mask) {
  Histograms counts;
  for (int y = 0; y < hsv.rows; ++y) {
    for (int x = 0; x < hsv.cols; ++x) {
      if (!mask.at<uint8_t>(y, x)) continue;
      const auto& p = hsv.at<cv::Vec3b>(y, x);
      ++counts.hue[p[0]];
      ++counts.saturation[p[1]];
      ++counts.value[p[2]];
      ++counts.pixels;
    }
  }
  return counts;
}

/// The level below which `share` of the pixels are.
template <size_t N>
int Quantile(const std::array<int, N>& histogram, int pixels, double share) {
  int below = 0;
  for (size_t level = 0; level < N; ++level) {
    below += histogram[level];
    if (below > share * pixels) return static_cast<int>(level);
  }
  return static_cast<int>(N) - 1;
}

/// The hues as [low, low + span]: the circle is cut opposite to their mean.
std::pair<int, int> HueArc(const Histograms& counts) {
  double x = 0, y = 0;
  for (size_t h = 0; h < counts.hue.size(); ++h) {
    x += counts.hue[h] * std::cos(static_cast<double>(h) * M_PI / 90);
    y += counts.hue[h] * std::sin(static_cast<double>(h) * M_PI / 90);
  }
  const int cut = (static_cast<int>(std::lround(std::atan2(y, x) * 90 / M_PI)) + 270) % 180;
  std::array<int, 180> turned{};
  for (int h = 0; h < 180; ++h) turned[static_cast<size_t>(h)] = counts.hue[static_cast<size_t>((h + cut) % 180)];
  const int low = Quantile(turned, counts.pixels, kOutside), high = Quantile(turned, counts.pixels, 1 - kOutside);
  return {(low + cut) % 180, high - low};
}

HsvRange WithMargin(const Histograms& counts, bool grey, double share) {
  const auto margin = [&](int k) { return static_cast<int>(std::lround(share * kMargin[static_cast<size_t>(k)])); };
  const auto quantile = [&](const auto& histogram, double at) { return Quantile(histogram, counts.pixels, at); };
  HsvRange range;
  range.low[2] = std::max(15, quantile(counts.value, kOutside) - margin(2));
  if (grey) {
    range.high[1] = std::min(255, quantile(counts.saturation, 1 - kOutside) + margin(1) / 2);
    range.high[2] = std::min(255, quantile(counts.value, 1 - kOutside) + margin(2));
    return range;
  }
  const auto [low, span] = HueArc(counts);
  const int around = margin(0) + 1;
  if (span + 2 * around < 179) {
    range.low[0] = (low - around + 180) % 180;
    range.high[0] = (low + span + around) % 180;
  }
  range.low[1] = std::max(0, quantile(counts.saturation, kOutside) - margin(1));
  return range;
}

/// The hues of a range as one or two plain intervals.
std::vector<std::pair<int, int>> HueIntervals(const HsvRange& range) {
  if (range.low[0] <= range.high[0]) return {{range.low[0], range.high[0]}};
  return {{range.low[0], 179}, {0, range.high[0]}};
}

}  // namespace

PixelMask ClickedRegion(const Frame& frame, const std::optional<Plane>& table, int x, int y) {
  const cv::Rect image({0, 0}, frame.colour.size());
  if (!image.contains({x, y})) return {};
  const cv::Mat hsv = Hsv(frame.colour);
  const bool depth = table && frame.depth.size() == frame.colour.size();
  const cv::Mat heights = depth ? Heights(frame, *table) : cv::Mat();
  const bool above = depth && heights.at<float>(y, x) > kLeastHeight;
  const cv::Vec3b seed = MiddleColour(frame.colour, x, y);
  const auto belongs = [&](int u, int v) {
    return Like(seed, hsv.at<cv::Vec3b>(v, u)) && !(above && heights.at<float>(v, u) < kLeastHeight);
  };
  PixelMask region(frame.colour.size(), CV_8UC1, cv::Scalar(0));
  std::vector<cv::Point> open{{x, y}};
  region.at<uint8_t>(y, x) = 255;
  while (!open.empty()) {
    const cv::Point p = open.back();
    open.pop_back();
    for (const cv::Point q : {p + cv::Point(1, 0), p - cv::Point(1, 0), p + cv::Point(0, 1), p - cv::Point(0, 1)}) {
      if (!image.contains(q) || region.at<uint8_t>(q) || !belongs(q.x, q.y)) continue;
      region.at<uint8_t>(q) = 255;
      open.push_back(q);
    }
  }
  cv::erode(region, region, cv::Mat());
  return region;
}

PixelMask InsideOf(const std::vector<Polygon>& silhouette, const cv::Size& size) {
  PixelMask mask(size, CV_8UC1, cv::Scalar(0));
  std::vector<std::vector<cv::Point>> lines;
  for (const auto& polygon : silhouette) {
    auto& line = lines.emplace_back();
    for (const auto& p : polygon) line.emplace_back(cvRound(p.x()), cvRound(p.y()));
  }
  if (!lines.empty()) cv::fillPoly(mask, lines, cv::Scalar(255));
  cv::erode(mask, mask, cv::Mat(), cv::Point(-1, -1), 3);
  return mask;
}

PixelMask TablePixels(const Frame& frame, const Plane& table) {
  return cv::abs(Heights(frame, table)) < kTableTolerance;
}

std::optional<HsvRange> SuggestRange(const cv::Mat& bgr, const PixelMask& part, const PixelMask& background) {
  if (part.size() != bgr.size()) return std::nullopt;
  const Histograms counts = Count(Hsv(bgr), part);
  if (counts.pixels < kLeastPixels) return std::nullopt;
  const bool grey = Quantile(counts.saturation, counts.pixels, 0.5) < kGrey;
  HsvRange range;
  for (const double margin : {1.0, 0.75, 0.5, 0.25, 0.0}) {
    range = WithMargin(counts, grey, margin);
    if (ShareIn(range, bgr, background) <= kBackgroundShare) break;
  }
  return range;
}

double ShareIn(const HsvRange& range, const cv::Mat& bgr, const PixelMask& mask) {
  if (mask.size() != bgr.size()) return 0;
  const cv::Mat hsv = Hsv(bgr);
  int inside = 0, all = 0;
  for (int y = 0; y < hsv.rows; ++y) {
    for (int x = 0; x < hsv.cols; ++x) {
      if (!mask.at<uint8_t>(y, x)) continue;
      const auto& p = hsv.at<cv::Vec3b>(y, x);
      ++all;
      inside += Contains(range, p[0], p[1], p[2]);
    }
  }
  return all > 0 ? static_cast<double>(inside) / all : 0;
}

bool Overlap(const HsvRange& a, const HsvRange& b) {
  for (size_t k = 1; k < 3; ++k) {
    if (a.high[k] < b.low[k] || b.high[k] < a.low[k]) return false;
  }
  for (const auto& [low_a, high_a] : HueIntervals(a)) {
    for (const auto& [low_b, high_b] : HueIntervals(b)) {
      if (low_a <= high_b && low_b <= high_a) return true;
    }
  }
  return false;
}

}  // namespace coach
