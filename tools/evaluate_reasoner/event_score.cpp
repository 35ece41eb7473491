#include "tools/evaluate_reasoner/event_score.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace coach {
namespace {

constexpr double kWindow = 20;  // s

bool Same(const TrueEvent& t, const ConnectionEvent& s) {
  return t.type == s.type && std::find(t.names.begin(), t.names.end(), s.name) != t.names.end();
}

}  // namespace

EventScore& EventScore::operator+=(const EventScore& other) {
  truths += other.truths;
  found += other.found;
  within_1s += other.within_1s;
  within_5s += other.within_5s;
  false_alarms += other.false_alarms;
  wrong_truths += other.wrong_truths;
  wrong_found += other.wrong_found;
  unknown_truths += other.unknown_truths;
  unknown_found += other.unknown_found;
  disconnects += other.disconnects;
  disconnects_found += other.disconnects_found;
  delays.insert(delays.end(), other.delays.begin(), other.delays.end());
  dating.insert(dating.end(), other.dating.begin(), other.dating.end());
  return *this;
}

EventScore Score(const std::vector<TrueEvent>& truth, const std::vector<ConnectionEvent>& said) {
  std::vector<std::tuple<double, size_t, size_t>> candidates;
  for (size_t i = 0; i < truth.size(); ++i) {
    for (size_t j = 0; j < said.size(); ++j) {
      const double apart = std::abs(static_cast<double>(said[j].since - truth[i].moment)) * 1e-6;
      if (Same(truth[i], said[j]) && apart <= kWindow) candidates.emplace_back(apart, i, j);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<int> match(truth.size(), -1);
  std::vector<bool> used(said.size(), false);
  for (const auto& [apart, i, j] : candidates) {
    if (match[i] >= 0 || used[j]) continue;
    match[i] = static_cast<int>(j);
    used[j] = true;
  }
  EventScore score;
  for (size_t i = 0; i < truth.size(); ++i) {
    const TrueEvent& t = truth[i];
    if (t.type == "disconnect") {
      ++score.disconnects;
      score.disconnects_found += match[i] >= 0;
      continue;
    }
    if (t.names == std::vector<std::string>{"unknown"}) {
      ++score.unknown_truths;
      score.unknown_found += match[i] >= 0;
      continue;
    }
    ++score.truths;
    score.wrong_truths += t.type == "wrong";
    if (match[i] < 0) continue;
    const ConnectionEvent& s = said[match[i]];
    ++score.found;
    score.wrong_found += t.type == "wrong";
    const double delay = static_cast<double>(s.decided - t.due) * 1e-6;
    score.delays.push_back(delay);
    score.dating.push_back(static_cast<double>(s.since - t.moment) * 1e-6);
    score.within_1s += delay <= 1;
    score.within_5s += delay <= 5;
  }
  for (size_t j = 0; j < said.size(); ++j) score.false_alarms += !used[j] && said[j].type != "disconnect";
  return score;
}

}  // namespace coach
