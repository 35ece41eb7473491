// A lesson with a simulated clock: a child made of a few rules, a robot that speaks as long as its sentences last.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "services/assembly_reasoner/lesson.h"

namespace coach {

/// rectangle_long_short: parts 0 and 1 are long, 2 and 3 short.
const Task& Rectangle();
/// The shipped phrase files.
const std::map<std::string, PhraseBook>& Books();

class Classroom {
 public:
  explicit Classroom(uint64_t seed, LessonOptions options = {}, std::vector<Task> tasks = {Rectangle()});

  // What the child does.
  void Join(int a, int b, const Pose& X_AB) { joints_[{a, b}] = X_AB; }
  void JoinRight(int connection);
  void Undo(int a, int b) { joints_.erase({a, b}); }
  void Build();
  void TakeApart() { joints_.clear(); }

  LessonOutput Operator(OperatorKind kind, const std::string& argument = "");
  /// A new process takes over from the state file.
  void Restart();

  void Run(double seconds);
  /// The same where poses may be refused, as in the second after a change of task.
  void RunOn(double seconds);
  /// Time passes without a picture.
  void Wait(double seconds) { now_ += static_cast<int64_t>(1e6 * seconds); }

  struct Said {
    RobotCommand command;
    int64_t at = 0;
    AssemblyState state;
  };
  std::vector<Said> said;
  std::vector<GuidanceEvent> events;
  int refused = 0;  // poses
  bool moving = false, hidden = false, robot_reports = true;
  std::function<double(int64_t)> hand_speed = [](int64_t) { return 0.0; };  // m/s at a time in us

  int64_t now() const { return now_; }
  int64_t restarted() const { return restarted_; }  // us, the last time; 0 never
  const AssemblyState& state() const { return state_; }
  const std::map<std::pair<int, int>, Pose>& joints() const { return joints_; }
  std::mt19937_64& random() { return random_; }
  std::vector<std::string> Keys() const;
  int Count(const std::string& key) const;
  const GuidanceEvent* Find(const std::string& kind) const;  // the first; null: none

 private:
  void NewLesson();
  void Frame();
  Vector6 Shake();
  std::vector<Pose> PlacesOfParts() const;
  PartPoses Poses();
  void Note(const LessonOutput& out);

  std::vector<Task> tasks_;
  LessonOptions options_;
  std::mt19937_64 random_;
  std::unique_ptr<Lesson> lesson_;
  std::map<std::pair<int, int>, Pose> joints_;
  AssemblyState state_;
  int64_t now_ = 1000000, robot_until_ = 0, robot_id_ = 0, operator_id_ = 100, restarted_ = 0;
};

}  // namespace coach
