#include "tools/report/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace coach {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kZ = 1.959963984540054;  // 97.5 % of the normal distribution

}  // namespace

double Mean(const std::vector<double>& values) {
  if (values.empty()) return kNone;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double Deviation(const std::vector<double>& values) {
  if (values.size() < 2) return kNone;
  const double mean = Mean(values);
  double sum = 0;
  for (const double v : values) sum += (v - mean) * (v - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNone;
  std::sort(values.begin(), values.end());
  const double at = std::clamp(share, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto low = static_cast<size_t>(at);
  const size_t high = std::min(low + 1, values.size() - 1);
  return values[low] + (at - static_cast<double>(low)) * (values[high] - values[low]);
}

std::optional<Interval> WilsonInterval(double k, double n) {
  if (!(n > 0)) return std::nullopt;
  const double p = k / n, z2 = kZ * kZ;
  const double middle = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = kZ / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  return Interval{std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::optional<Interval> BootstrapInterval(size_t n, const std::function<double(const std::vector<size_t>&)>& statistic,
                                          const BootstrapOptions& options) {
  if (n < 2) return std::nullopt;
  std::mt19937_64 random(options.seed);
  std::vector<double> values;
  std::vector<size_t> drawn(n);
  for (int r = 0; r < options.resamples; ++r) {
    for (size_t& unit : drawn) unit = random() % n;
    const double value = statistic(drawn);
    if (std::isfinite(value)) values.push_back(value);
  }
  if (2 * values.size() < static_cast<size_t>(std::max(0, options.resamples)) || values.empty()) return std::nullopt;
  return Interval{Quantile(values, 0.025), Quantile(values, 0.975)};
}

}  // namespace coach
