// A lesson that goes on as long as it is watched, with a child that hears what the robot says.
#pragma once

#include <optional>
#include <string>

#include "tools/simulator/enactment.h"
#include "tools/simulator/scenario.h"

namespace coach {

struct LiveLessonOptions {
  enum class Temper {
    kListens,      ///< does what it is asked for and undoes what it is told is wrong
    kErrs,         ///< the same, but every second step is done wrong first
    kNeverListens  ///< builds what it likes, half of it wrong, and sees a mistake by itself after a while
  };
  Temper temper = Temper::kListens;
  double reaction = 1.0;      ///< s from hearing to acting
  double patience = 30.0;     ///< s without a word after which a child that listens builds what it likes
  double own_pace = 4.0;      ///< s between two acts of a child that does not listen
  double own_insight = 15.0;  ///< s until a child sees its mistake by itself
};

/// "listens", "errs" or "never-listens". @throws std::invalid_argument for another name.
LiveLessonOptions::Temper TemperByName(const std::string& name);

/// Time only grows. Acts are planned when their time comes, so what is said now changes what happens next.
class LiveLesson {
 public:
  /// @param scenario of kind "ready".
  LiveLesson(Scenario scenario, const LiveLessonOptions& options);
  LiveLesson(const LiveLesson&) = delete;
  LiveLesson& operator=(const LiveLesson&) = delete;

  /// The robot says something. @param phrase_key of ROBOT_COMMAND. @param step connection that the robot is at, -1 none
  void Hear(const std::string& phrase_key, int step);
  void Ask(int connection);  ///< the robot asks for this connection of the task
  void SayWrong();           ///< the robot says that the last joint is wrong
  /// Plans what happens up to `time` (s).
  void Advance(double time);
  bool complete() const;

  const Scenario& scenario() const { return scenario_; }
  const Performance& performance() const { return scenario_.performance; }

 private:
  void Decide(double time);
  void CorrectWhenTime(double time);
  bool DecidesAlone(double time) const;

  Scenario scenario_;
  LiveLessonOptions options_;
  Random random_;
  Structure structure_;
  Solids solids_;
  Child child_;
  Enactment lesson_;
  std::optional<int> asked_;
  bool told_wrong_ = false;
  int steps_ = 0;
  double last_act_ = 0;   // s, end of it
  double last_word_ = 0;  // s, when something was heard
};

}  // namespace coach
