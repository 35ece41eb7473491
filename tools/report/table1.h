// The paper's Table I, and what else is worth knowing of a set of trials.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/report/statistics.h"
#include "tools/report/trials.h"

namespace coach {

/// What one trial contributes.
struct TrialFigures {
  bool annotated = false, completed = false;
  double seconds = 0;
  int connections = 0, wrong = 0;  ///< true ones; without annotation those detected
  int detected_connections = 0, detected_wrong = 0, undone = 0;
  std::vector<double> delays_connect, delays_wrong;  ///< s, of those found
  std::vector<double> datings;                       ///< s, signed, of those found
  int reported = 0, false_alarms = 0;                ///< connect and wrong
  int spoken = 0, praise = 0, corrections = 0, hints = 0, repairs = 0, operator_orders = 0;
  double tracked_share = -1;                    ///< 0..1 of part-frames tracked; -1 unknown
  double latency_ms = -1, latency_p99_ms = -1;  ///< of the poses; -1 unknown
  int exchanges = 0;                            ///< identities of equal parts
};

TrialFigures FiguresOf(const Trial& trial, const Session& session);

struct Measure {
  std::string name, unit;
  double value = 0;                  ///< not a number: nothing to measure
  std::optional<int> k, n;           ///< of a share: successes and trials; of a mean or median only n
  std::optional<Interval> interval;  ///< 95 %
  std::string method;                ///< of the interval: bootstrap over trials, Wilson, or empty
  std::optional<double> paper;       ///< the paper's value for this kind of task
};

struct MeasureGroup {
  std::string title;  ///< All trials, Rectangles, Square, or a task's name
  int trials = 0;
  std::vector<Measure> measures;
};

/// All trials together, then rectangles, the square and every other task apart. Intervals are bootstrapped over whole
/// trials, as what happens within one hangs together; for one trial shares get Wilson's.
std::vector<MeasureGroup> Table1(const std::vector<Trial>& trials, const std::vector<TrialFigures>& figures,
                                 const BootstrapOptions& options = {});

}  // namespace coach
