// What a service counts about its own work.
#pragma once

#include <cstdint>
#include <deque>

namespace coach {

/// Values of the last 5 s. Times come from the caller (any clock, us), so tests need none.
class RollingWindow {
 public:
  static constexpr int64_t kLength = 5'000'000;  ///< us

  void Add(int64_t now, double value);
  double Rate(int64_t now);                        ///< values a second
  double Percentile(int64_t now, double percent);  ///< 0 if there are none
 private:
  void Forget(int64_t now);
  std::deque<std::pair<int64_t, double>> values_;
  int64_t first_ = -1;
};

/// Every input is answered or dropped in the end; what is neither yet is in work.
struct ServiceStatistics {
  RollingWindow latency_us;  ///< capture to publication
  RollingWindow work_us;     ///< one step
  int64_t received = 0;      ///< inputs
  int64_t answered = 0;      ///< inputs that led to an output
  int64_t dropped = 0;       ///< inputs superseded by newer ones, or of no use
};

}  // namespace coach
