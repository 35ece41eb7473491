#include "tools/evaluate/event_scores.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace coach {
namespace {

constexpr double kWindow = 20;  // s
constexpr double kOn = 0.3;     // visible fraction
constexpr double kPrompt = 1;   // s

struct True {
  double time;
  std::string connection, kind;
  std::vector<int> parts;
};

std::string ClassOf(const SceneTruth& truth, const std::string& connection) {
  const auto found = truth.joint_class.find(connection);
  return found == truth.joint_class.end() ? connection : found->second;
}

/// The first moment from `time` on when all the parts can be seen; `time` if there is none.
double Due(const SceneTruth& truth, double time, const std::vector<int>& parts) {
  for (size_t f = 0; f < truth.image_ids.size(); ++f) {
    const double at = truth.image_ids[f] / truth.fps;
    if (truth.image_ids[f] < static_cast<int>(time * truth.fps)) continue;
    if (std::all_of(parts.begin(), parts.end(),
                    [&](int k) { return truth.visible[f][static_cast<size_t>(k)] >= kOn; })) {
      return std::max(time, at);
    }
  }
  return time;
}

std::map<std::string, int> FinalState(const SceneTruth& truth, const std::vector<EventRow>& events) {
  std::map<std::string, int> state;
  for (const EventRow& e : events) state[ClassOf(truth, e.connection)] += e.kind == "disconnect" ? -1 : 1;
  std::erase_if(state, [](const auto& entry) { return entry.second <= 0; });
  return state;
}

}  // namespace

EventScores ScoreEvents(const SceneTruth& truth, const Estimates& estimates) {
  std::vector<True> made;
  std::vector<EventRow> all_true;
  for (const TruthEvent& e : truth.events) {
    const std::string kind = e.kind == "connect"         ? "connect"
                             : e.kind == "wrong_connect" ? "wrong"
                             : e.kind == "disconnect"    ? "disconnect"
                                                         : "";
    if (kind.empty()) continue;
    all_true.push_back({e.time, e.connection, kind, e.time});
    if (kind != "disconnect") made.push_back({e.time, e.connection, kind, e.parts});
  }
  std::vector<EventRow> said;
  for (const EventRow& e : estimates.events) {
    if (e.kind == "connect" || e.kind == "wrong") said.push_back(e);
  }
  struct Pair {
    double difference;
    size_t i, j;
  };
  std::vector<Pair> pairs;
  for (size_t i = 0; i < made.size(); ++i) {
    for (size_t j = 0; j < said.size(); ++j) {
      const double difference = std::abs(said[j].time - made[i].time);
      if (made[i].kind == said[j].kind && ClassOf(truth, made[i].connection) == ClassOf(truth, said[j].connection) &&
          difference <= kWindow) {
        pairs.push_back({difference, i, j});
      }
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.difference < b.difference; });
  EventScores scores;
  std::vector<bool> used(said.size(), false);
  for (const True& t : made) scores.connections.push_back({t.connection, t.time, std::nullopt, std::nullopt});
  std::vector<double> differences;
  for (const Pair& p : pairs) {
    Announcement& a = scores.connections[p.i];
    if (a.error || used[p.j]) continue;
    used[p.j] = true;
    a.error = said[p.j].time - a.time;
    a.delay = said[p.j].decided - Due(truth, a.time, made[p.i].parts);
    differences.push_back(p.difference);
    scores.within_1s += *a.delay <= kPrompt;
  }
  scores.reported = static_cast<int>(said.size());
  scores.matched = static_cast<int>(differences.size());
  scores.false_alarms = scores.reported - scores.matched;
  scores.time_error = Summarise(differences);
  const auto share = [&](double limit) {
    const auto n = std::count_if(differences.begin(), differences.end(), [&](double d) { return d <= limit; });
    return made.empty() ? 0.0 : 100.0 * static_cast<double>(n) / static_cast<double>(made.size());
  };
  scores.found_5 = share(5);
  scores.found_20 = share(20);
  scores.final_state_right = FinalState(truth, all_true) == FinalState(truth, estimates.events);
  return scores;
}

}  // namespace coach
