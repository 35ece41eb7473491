#include "services/detector/white_balance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace coach {
namespace {

constexpr int kStep = 8;            // px
constexpr int kBins = 128;          // each way
constexpr double kBinWidth = 0.02;  // of the logarithm
constexpr int kReach = 3;           // bins about the peak that belong to it
constexpr double kLeastShare = 0.05;
constexpr int kDarkest = 25, kBrightest = 250;
constexpr double kLargestShift = 0.4;

}  // namespace

std::optional<Chromaticity> BackgroundChromaticity(const cv::Mat& bgr) {
  static const std::array<double, 256> kLog = [] {
    std::array<double, 256> logs{};
    for (size_t i = 1; i < logs.size(); ++i) logs[i] = std::log(static_cast<double>(i));
    return logs;
  }();
  std::vector<int> histogram(kBins * kBins);
  std::vector<Chromaticity> samples;
  const auto bin = [](double value) { return static_cast<int>(std::floor(value / kBinWidth)) + kBins / 2; };
  int looked_at = 0;
  for (int y = kStep / 2; y < bgr.rows; y += kStep) {
    const cv::Vec3b* row = bgr.ptr<cv::Vec3b>(y);
    for (int x = kStep / 2; x < bgr.cols; x += kStep) {
      const cv::Vec3b& p = row[x];
      ++looked_at;
      if (std::min({p[0], p[1], p[2]}) < kDarkest || std::max({p[0], p[1], p[2]}) > kBrightest) continue;
      const Chromaticity c{kLog[p[0]] - kLog[p[1]], kLog[p[2]] - kLog[p[1]]};
      const int u = bin(c.blue_green), v = bin(c.red_green);
      if (u < 0 || v < 0 || u >= kBins || v >= kBins) continue;
      ++histogram[static_cast<size_t>(v * kBins + u)];
      samples.push_back(c);
    }
  }
  // The peak of the histogram summed over 3 x 3 bins.
  int best = 0, best_u = 0, best_v = 0;
  for (int v = 1; v + 1 < kBins; ++v) {
    for (int u = 1; u + 1 < kBins; ++u) {
      int sum = 0;
      for (int dv = -1; dv <= 1; ++dv) {
        for (int du = -1; du <= 1; ++du) sum += histogram[static_cast<size_t>((v + dv) * kBins + u + du)];
      }
      if (sum > best) {
        best = sum;
        best_u = u;
        best_v = v;
      }
    }
  }
  Chromaticity mean;
  int members = 0;
  for (const Chromaticity& c : samples) {
    if (std::abs(bin(c.blue_green) - best_u) > kReach || std::abs(bin(c.red_green) - best_v) > kReach) continue;
    mean.blue_green += c.blue_green;
    mean.red_green += c.red_green;
    ++members;
  }
  if (members == 0 || members < kLeastShare * looked_at) return std::nullopt;
  return Chromaticity{mean.blue_green / members, mean.red_green / members};
}

ChannelGains BalancingGains(const Chromaticity& reference, const Chromaticity& seen) {
  const double blue = reference.blue_green - seen.blue_green, red = reference.red_green - seen.red_green;
  if (!(std::abs(blue) <= kLargestShift && std::abs(red) <= kLargestShift)) return {1, 1, 1};
  return {static_cast<float>(std::exp(blue)), 1, static_cast<float>(std::exp(red))};
}

}  // namespace coach
