// A session's lessons, and what was right and wrong in each.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/report/session.h"

namespace coach {

/// From the moment a task is begun until it is first complete, begun anew, another one chosen, or the log ends. What is
/// taken apart afterwards belongs to no trial.
struct TrialSpan {
  std::string task;  ///< empty: unknown
  int64_t begin = 0, end = 0;
  bool started = true;     ///< false: the log has no beginning of a lesson; everything is taken for one
  bool completed = false;  ///< the reasoner said so
};

/// In the order of time, not overlapping.
std::vector<TrialSpan> FindTrials(const Session& session);

/// The names of the task, else the last ones known; nothing if the session has none.
const TaskNames* NamesOf(const Session& session, const std::string& task);

/// A connection or mistake that was made, or undone, in truth.
struct TrueEvent {
  Annotation annotation;
  std::optional<size_t> detected;  ///< index into Trial::detected
  double delay = 0;                ///< s, announced - the later of truth and first sight of both parts; if detected
  double dating = 0;               ///< s, estimated moment - true moment; if detected
};

/// What was decided about a connection.
struct DetectedEvent {
  GuidanceEvent event;
  std::optional<size_t> truth;  ///< index into Trial::truth
};

struct Trial {
  std::string session;
  int number = 0;  ///< in its session, from 1
  TrialSpan span;
  int64_t until =
      0;  ///< us, end of what counts: the span's, or later true connections if it was called complete before
  bool annotated = false;
  std::vector<TrueEvent> truth;         ///< connect, wrong, disconnect
  std::vector<DetectedEvent> detected;  ///< connect, wrong, disconnect
  std::vector<GuidanceEvent> events;    ///< all, these too
  double seconds() const { return static_cast<double>(span.end - span.begin) / 1e6; }
};

/// The session's trials with their events, matched: a detected event is that of a true one of the same kind and joint
/// class, one to one, smallest time difference first, within 20 s. The class of a connection is the two types of parts
/// it joins, where the log tells them, as equal parts may stand for each other; else its name. A true mistake called
/// unknown is any mistake.
std::vector<Trial> Trials(const Session& session);

}  // namespace coach
