#include "tools/report/trials.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace coach {
namespace {

constexpr int64_t kWindow = 20000000;    // us between a true event and its detection
constexpr int64_t kLastWords = 8000000;  // us after completion in which what is said belongs to the trial
constexpr int64_t kNotedLate = 1000000;  // us after the last connection that its announcement may take
constexpr float kSeen = 0.3F;            // visible fraction from which on a part can be judged

bool Refused(const GuidanceEvent& e) { return e.reason.starts_with("refused: "); }
bool IsJoint(const std::string& kind) { return kind == "connect" || kind == "wrong" || kind == "disconnect"; }

/// Follows the decisions and says where trials begin and end.
class TrialFinder {
 public:
  void Take(const GuidanceEvent& e) {
    const bool by_itself = e.kind == "session" && e.subject == "next_task";
    if (by_itself || (e.kind == "operator" && e.subject == "choose_task" && !Refused(e))) {
      task_ = e.reason;
      if (open_) Begin(e.utime);
    } else if (e.kind == "operator" && e.subject == "start" && !Refused(e)) {
      Begin(e.utime);
    } else if ((e.kind == "phase" || e.kind == "say") && e.subject == "introduction") {
      Begin(e.utime);
    } else if (e.kind == "phase" && e.subject == "complete") {
      if (trials_.empty()) Open(e.utime);
      if (!open_) return;  // taken apart and put together again
      trials_.back().end = e.utime;
      trials_.back().completed = true;
      open_ = false;
    } else if (e.kind == "phase") {
      if (trials_.empty()) Open(e.utime);  // the log begins in the middle of a lesson
      fresh_ = false;
    }
    if (open_) trials_.back().end = std::max(trials_.back().end, e.utime);
  }
  std::vector<TrialSpan> Finish(int64_t end) {
    if (open_) trials_.back().end = std::max(trials_.back().end, end);
    return std::move(trials_);
  }

 private:
  /// The button, the phase and the first sentence are one beginning.
  void Begin(int64_t utime) {
    if (open_ && fresh_) {
      trials_.back().task = task_;
      return;
    }
    if (open_) trials_.back().end = utime;
    Open(utime);
  }
  void Open(int64_t utime) {
    TrialSpan trial;
    trial.task = task_;
    trial.begin = trial.end = utime;
    trials_.push_back(trial);
    open_ = fresh_ = true;
  }

  std::vector<TrialSpan> trials_;
  std::string task_;
  bool open_ = false, fresh_ = false;
};

/// The bus says which task it is; the event log only when one is chosen.
std::string TaskAt(const Session& session, const TrialSpan& span) {
  for (const AssemblyState& state : session.states) {
    if (state.utime >= span.begin && !state.task.empty()) return state.task;
  }
  if (!span.task.empty()) return span.task;
  return session.tasks.size() == 1 ? session.tasks[0].name : "";
}

/// Joint class of connections by their names.
class JointClasses {
 public:
  JointClasses(const Session& session, const TaskNames* names) : names_(names) {
    if (!names_) return;
    for (const GuidanceEvent& e : session.events) {
      if (e.kind == "connect") Learn(e.subject, e.part_a, e.part_b);
    }
    for (const AssemblyState& state : session.states) {
      if (state.task != names_->name) continue;
      for (const ConnectionState& c : state.connections) {
        if (c.connection >= 0 && c.connection < static_cast<int>(names_->connections.size()))
          Learn(names_->connections[static_cast<size_t>(c.connection)], c.part_a, c.part_b);
      }
    }
  }

  std::string Of(const std::string& name) const {
    const auto found = types_.find(name);
    return found == types_.end() ? name : found->second;
  }

 private:
  void Learn(const std::string& name, int a, int b) {
    const auto type = [&](int part) {
      return part >= 0 && part < static_cast<int>(names_->part_types.size())
                 ? names_->part_types[static_cast<size_t>(part)]
                 : -1;
    };
    const auto [low, high] = std::minmax({type(a), type(b)});
    if (low >= 0) types_.emplace(name, "types " + std::to_string(low) + " " + std::to_string(high));
  }

  const TaskNames* names_;
  std::map<std::string, std::string> types_;
};

bool Fits(const TrueEvent& truth, const GuidanceEvent& e, const JointClasses& classes) {
  const std::string& name = truth.annotation.subject;
  if (truth.annotation.kind != e.kind) return false;
  if (name == e.subject || classes.Of(name) == classes.Of(e.subject)) return true;
  return e.kind != "connect" && (name == "unknown" || e.subject == "unknown");
}

/// The first moment from `from` on at which both parts can be judged; `from` if the log does not tell.
int64_t FirstSight(const Session& session, int64_t from, const GuidanceEvent& e) {
  const auto seen = [](const TrackedFrame& f, int part) {
    return part < 0 || part >= static_cast<int>(f.parts.size()) || f.parts[static_cast<size_t>(part)].visible >= kSeen;
  };
  auto frame = std::upper_bound(session.frames.begin(), session.frames.end(), from,
                                [](int64_t t, const TrackedFrame& f) { return t < f.utime; });
  if (frame != session.frames.begin()) --frame;  // what was seen when it happened
  for (; frame != session.frames.end() && frame->utime <= from + kWindow; ++frame) {
    if (seen(*frame, e.part_a) && seen(*frame, e.part_b)) return std::max(from, frame->utime);
  }
  return from;
}

/// The end of what counts: a lesson that was called complete too early goes on until the observer's last connection.
int64_t Until(const Session& session, const TrialSpan& span, int64_t next) {
  int64_t until = span.end;
  for (const Annotation& a : session.annotations) {
    const bool counts = a.kind == "connect" || a.kind == "wrong";
    if (span.completed && counts && a.utime > span.end && a.utime < next) until = std::max(until, a.utime + kNotedLate);
  }
  return std::min(until, next);
}

void Match(const Session& session, Trial& trial) {
  const JointClasses classes(session, NamesOf(session, trial.span.task));
  struct Pair {
    int64_t difference;
    size_t truth, detected;
  };
  std::vector<Pair> pairs;
  for (size_t t = 0; t < trial.truth.size(); ++t) {
    for (size_t d = 0; d < trial.detected.size(); ++d) {
      const GuidanceEvent& e = trial.detected[d].event;
      const int64_t difference = std::abs(e.since - trial.truth[t].annotation.utime);
      if (difference <= kWindow && Fits(trial.truth[t], e, classes)) pairs.push_back({difference, t, d});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const Pair& a, const Pair& b) { return a.difference < b.difference; });
  for (const Pair& p : pairs) {
    TrueEvent& truth = trial.truth[p.truth];
    DetectedEvent& detected = trial.detected[p.detected];
    if (truth.detected || detected.truth) continue;
    truth.detected = p.detected;
    detected.truth = p.truth;
    const GuidanceEvent& e = detected.event;
    truth.dating = static_cast<double>(e.since - truth.annotation.utime) / 1e6;
    truth.delay = static_cast<double>(e.utime - FirstSight(session, truth.annotation.utime, e)) / 1e6;
  }
}

}  // namespace

std::vector<TrialSpan> FindTrials(const Session& session) {
  TrialFinder finder;
  for (const GuidanceEvent& e : session.events) finder.Take(e);
  std::vector<TrialSpan> trials = finder.Finish(session.end);
  if (trials.empty() && session.end > session.begin) {
    TrialSpan whole;
    whole.begin = session.begin;
    whole.end = session.end;
    whole.started = false;
    trials.push_back(whole);
  }
  for (TrialSpan& trial : trials) trial.task = TaskAt(session, trial);
  return trials;
}

const TaskNames* NamesOf(const Session& session, const std::string& task) {
  for (auto t = session.tasks.rbegin(); t != session.tasks.rend(); ++t) {
    if (t->name == task) return &*t;
  }
  return session.tasks.empty() ? nullptr : &session.tasks.back();
}

std::vector<Trial> Trials(const Session& session) {
  std::vector<Trial> trials;
  const auto spans = FindTrials(session);
  for (size_t i = 0; i < spans.size(); ++i) {
    Trial trial;
    trial.session = session.name;
    trial.number = static_cast<int>(i) + 1;
    trial.span = spans[i];
    const int64_t next = i + 1 < spans.size() ? spans[i + 1].begin : INT64_MAX;
    trial.until = Until(session, trial.span, next);
    for (const Annotation& a : session.annotations) {
      if (!IsJoint(a.kind)) continue;
      trial.annotated = true;
      if (a.utime >= trial.span.begin && a.utime <= trial.until) trial.truth.push_back({a, std::nullopt, 0, 0});
    }
    for (const GuidanceEvent& e : session.events) {
      const bool last_words = trial.span.completed && e.kind == "say" && e.utime <= trial.span.end + kLastWords;
      if (e.utime < trial.span.begin || (e.utime > trial.until && !last_words) || e.utime >= next) continue;
      trial.events.push_back(e);
      if (IsJoint(e.kind)) trial.detected.push_back({e, std::nullopt});
    }
    Match(session, trial);
    trials.push_back(std::move(trial));
  }
  return trials;
}

}  // namespace coach
