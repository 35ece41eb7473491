// A lesson: tasks one after the other, the reasoner that watches, the policy that answers, the operator who overrides.
// Pure: poses, operator commands and robot statuses in; state, belief, events and robot commands out. Time is that of
// the poses.
//
// After the last praise of a task that another one follows, the lesson rests: what was built may be taken apart,
// nothing is asked for. The next task is introduced after the pause, or at once when the operator says `start` or
// `skip`; he may pause, and choose another task instead.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "common/assembly/robot_act.h"
#include "services/assembly_reasoner/assembly_reasoner.h"
#include "services/assembly_reasoner/phrase_book.h"
#include "services/assembly_reasoner/response_policy.h"
#include "services/assembly_reasoner/speech_queue.h"

namespace coach {

struct LessonOptions {
  AssemblyReasonerOptions reasoner;
  ResponseOptions response;
  SpeechOptions speech;
  std::string language = "en";
  bool group = false;            ///< a group of children is spoken to, not one
  bool start_by_itself = false;  ///< the lesson begins with the first poses, not with the operator's word
  int no_repeat = 3;             ///< of the last wordings of a kind none is chosen again
  double validity = 8;           ///< s for which a command to the robot holds
  uint64_t seed = 1;             ///< of the choice of wordings
  int in_a_row = 1;              ///< of the tasks, so many from the first on follow each other by themselves
  double task_pause = 20;        ///< s of rest after the last praise of a task until the next one is introduced
  double task_change = 1;        ///< s after a change of task for which poses may still be of the former one's parts
};

struct LessonOutput {
  bool accepted = true;  ///< false: the poses were refused
  std::string refused;   ///< why
  AssemblyState state;
  ConnectionBelief belief;
  std::vector<GuidanceEvent> events;
  std::vector<RobotCommand> commands;  ///< sent_utime and hmac are left to the sender
};

/// What has to survive a restart.
struct LessonMemory {
  int64_t session = 0;
  std::string task, language;
  bool begun = false, greeted = false;
  AssemblyMemory assembly;
  PolicyMemory policy;
  std::vector<int> skipped;
  int64_t last_event = 0, last_command = 0;
};

class Lesson {
 public:
  /// @param tasks at least one; the first is chosen
  /// @param books by language; at least that of the options
  /// @throws std::invalid_argument if either is missing
  Lesson(std::vector<Task> tasks, std::map<std::string, PhraseBook> books, const LessonOptions& options,
         std::string station);

  LessonOutput Step(const PartPoses& poses);
  /// What the operator wants is done at once or refused, with an event either way.
  LessonOutput Handle(const OperatorCommand& command);
  void Handle(const RobotStatus& status);

  const Task& task() const { return tasks_[chosen_]; }
  int64_t session() const { return session_; }

  LessonMemory Save() const;
  /// @throws std::invalid_argument if it does not fit the tasks
  void Restore(const LessonMemory& memory);

 private:
  void Choose(size_t task);
  void Begin(int64_t session);
  LessonView View(std::vector<ConnectionEvent> events) const;
  bool HasNext() const { return static_cast<int>(chosen_) + 1 < options_.in_a_row; }
  void Rest(LessonOutput& out);
  void BeginNext(LessonOutput& out);
  bool IsTrue(const Utterance& utterance, const LessonView& view) const;
  void Speak(LessonOutput& out);
  void Say(const Utterance& utterance, LessonOutput& out);
  RobotCommand Command(const Utterance& utterance);
  void Aim(const Utterance& utterance, RobotCommand& command) const;
  std::string Words(const Utterance& utterance, RobotCommand& command);
  std::string Obey(const OperatorCommand& command, LessonOutput& out);
  std::string ChooseTask(const std::string& name);
  std::string Skip(LessonOutput& out);
  std::string Mark(const std::string& name, bool made, LessonOutput& out);
  void SayAtOnce(const std::string& key, const std::string& text, LessonOutput& out);
  void Stop(LessonOutput& out);
  void Tell(const std::vector<ConnectionEvent>& events, LessonOutput& out);
  void Emit(GuidanceEvent event, LessonOutput& out);
  void Finish(LessonOutput& out);

  std::vector<Task> tasks_;
  std::map<std::string, PhraseBook> books_;
  LessonOptions options_;
  std::string station_, language_;
  size_t chosen_ = 0;
  std::unique_ptr<AssemblyReasoner> reasoner_;
  SpeechQueue speech_;
  ResponsePolicy policy_;
  bool begun_ = false;
  bool greeted_ = false;           // in this session
  bool resting_ = false;           // between two tasks
  bool next_told_ = false;         // that another task follows
  int64_t rested_since_ = 0;       // us; 0: the pause has not begun
  int64_t now_ = 0, changed_ = 0;  // us, of the last poses; of them when the task was changed, 0 never
  int64_t session_ = 0, last_event_ = 0, last_command_ = 0, help_requests_ = -1;
  std::vector<int> skipped_;
  std::optional<PartPoses> poses_;
  RobotCommand last_said_;
  std::map<std::string, std::deque<int>> wordings_;  // last ones by kind
  std::deque<GuidanceEvent> recent_;
  std::mt19937_64 random_;
  AssemblyState state_;
};

}  // namespace coach
