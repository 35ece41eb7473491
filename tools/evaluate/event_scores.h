// How well connections were noticed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/estimates.h"
#include "tools/evaluate/pose_scores.h"

namespace coach {

struct Announcement {
  std::string connection;
  double time = 0;              ///< s, true
  std::optional<double> error;  ///< s, reported time - true time
  std::optional<double> delay;  ///< s, decided - first moment after the true time when both parts are 0.3 visible
};

struct EventScores {
  std::vector<Announcement> connections;  ///< every true connection, right or wrong
  int reported = 0, matched = 0;
  int false_alarms = 0;
  int within_1s = 0;                 ///< announced within 1 s of being visible
  Statistics time_error;             ///< s, absolute
  double found_5 = 0, found_20 = 0;  ///< % whose reported time is within 5 s, 20 s
  bool final_state_right = false;
};

/// A reported event matches a true one of the same joint class and kind, one to one, smallest time difference first,
/// within 20 s.
EventScores ScoreEvents(const SceneTruth& truth, const Estimates& estimates);

}  // namespace coach
