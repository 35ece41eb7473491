#include "common/bus/service_statistics.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace coach {

void RollingWindow::Forget(int64_t now) {
  while (!values_.empty() && values_.front().first <= now - kLength) values_.pop_front();
}

void RollingWindow::Add(int64_t now, double value) {
  if (first_ < 0) first_ = now;
  Forget(now);
  values_.emplace_back(now, value);
}

double RollingWindow::Rate(int64_t now) {
  Forget(now);
  if (values_.empty()) return 0;
  // The first seconds of a service are shorter than the window.
  const int64_t length = std::clamp<int64_t>(now - first_, 1'000'000, kLength);
  return static_cast<double>(values_.size()) * 1e6 / static_cast<double>(length);
}

double RollingWindow::Percentile(int64_t now, double percent) {
  Forget(now);
  if (values_.empty()) return 0;
  std::vector<double> values;
  for (const auto& [time, value] : values_) values.push_back(value);
  const auto rank = static_cast<size_t>(std::lround(percent / 100 * static_cast<double>(values.size() - 1)));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

}  // namespace coach
