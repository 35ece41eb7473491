// Scores connection events against the true ones, by the rules of docs/guidance.md ("Evaluation vocabulary").
#pragma once

#include <vector>

#include "services/assembly_reasoner/assembly_reasoner.h"
#include "tools/evaluate_reasoner/pose_script.h"

namespace coach {

struct EventScore {
  int truths = 0;     ///< connect and wrong events that happened
  int found = 0;      ///< matched: same type, one of the names, within 20 s, one to one
  int within_1s = 0;  ///< decided at most 1 s after they were due
  int within_5s = 0;
  int false_alarms = 0;                       ///< connect and wrong events that match nothing
  int wrong_truths = 0, wrong_found = 0;      ///< mistakes of the task
  int unknown_truths = 0, unknown_found = 0;  ///< contacts in no class; counted nowhere else
  int disconnects = 0, disconnects_found = 0;
  std::vector<double> delays;  ///< s, decided - due
  std::vector<double> dating;  ///< s, since - moment
  EventScore& operator+=(const EventScore& other);
};

EventScore Score(const std::vector<TrueEvent>& truth, const std::vector<ConnectionEvent>& said);

}  // namespace coach
