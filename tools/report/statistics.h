// The few statistics of a report, and how sure they are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace coach {

/// Not a number for no values.
double Mean(const std::vector<double>& values);
/// Standard deviation of the sample (n - 1); not a number for fewer than two.
double Deviation(const std::vector<double>& values);
/// Linear between the two nearest ranks; not a number for no values. @param share 0..1
double Quantile(std::vector<double> values, double share);
inline double Median(const std::vector<double>& values) { return Quantile(values, 0.5); }

struct Interval {
  double low = 0, high = 0;
};

/// 95 % interval of k successes of n (Wilson 1927); nothing for n = 0.
std::optional<Interval> WilsonInterval(double k, double n);

struct BootstrapOptions {
  uint64_t seed = 1;
  int resamples = 2000;
};

/// 95 % percentile interval of a statistic under resampling of n units with replacement (Efron 1979). The statistic
/// gets the drawn units' numbers; what is not finite is left out. Nothing for fewer than two units, or if less than
/// half of the resamples gave a number.
std::optional<Interval> BootstrapInterval(size_t n, const std::function<double(const std::vector<size_t>&)>& statistic,
                                          const BootstrapOptions& options = {});

}  // namespace coach
