// What the robot answers to the state of the assembly: phases, thresholds, hint ladder, corrections and their repair.
// Level-triggered: each Step looks at the whole state, so a lost frame or a restart changes nothing. Time is that of
// the data. The child hears of no joint whose two parts were not both seen in it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/assembly_state.h"
#include "services/assembly_reasoner/assembly_reasoner.h"
#include "services/assembly_reasoner/speech_queue.h"

namespace coach {

struct ResponseOptions {
  double praise_probability = 0.7;              ///< of a right connection, to praise it
  double praise_hold = 0.5;                     ///< s it has to last
  double correct_probability = 0.85;            ///< of a wrong connection, to correct it
  double correct_hold = 2.0;                    ///< s it has to last, the parts being still
  double correct_margin = 0.2;                  ///< above every right reading of the same two parts
  double correct_gap = 12;                      ///< s between two sayings of the same correction
  int correct_times = 3;                        ///< then the whole help once, then silence
  double hedge_low = 0.35;                      ///< probability of a right or wrong connection from which on ..
  double hedge_hold = 5.0;                      ///< s .. in doubt the child is asked to look once more
  double hedge_gap = 30;                        ///< s between two of these
  std::array<double, 4> idle{25, 45, 70, 100};  ///< s without movement after the last utterance, of hints 1 to 4
  double away = 90;            ///< s without movement after the last hint until nobody seems to be there
  double lost = 3;             ///< s that most parts can't be seen before it is said
  double lost_gap = 60;        ///< s between two sayings of it
  double repair_window = 15;   ///< s after a correction in which it is taken back if it was wrong
  double moving_speed = 0.05;  ///< m/s from which on a part or a hand counts as moving
  double hand_time = 0.3;      ///< s that a hand's movement has to last: the seen part of a resting arm jitters
  double still_time = 0.7;     ///< s without movement after which parts, or parts and hands, are still
};

/// What the policy looks at.
struct LessonView {
  int64_t now = 0;  ///< us
  const AssemblyReasoner* reasoner = nullptr;
  const PartPoses* poses = nullptr;
  std::vector<ConnectionEvent> events;  ///< of this step
  std::vector<int> skipped;             ///< connections that the operator skips
};

/// Label and parts of a joint.
using JointName = std::array<int, 3>;

/// What has to survive a restart.
struct PolicyMemory {
  Phase phase = Phase::kIntroduction;
  int step = -1;                                                   ///< connection asked for; -1 none
  int made_before = 0;                                             ///< connections made when it began
  bool introduced = false, announced = false, celebrated = false;  ///< the task, the step, the end
  int idle_level = 0;
  std::map<JointName, int> corrections;  ///< times each was said
  int repairs = 0;
};

class ResponsePolicy {
 public:
  ResponsePolicy(const ResponseOptions& options, SpeechQueue& speech) : options_(options), speech_(speech) {}

  /// Begins a task: introduction, then the first step.
  /// @param greeted the child was greeted before in this session
  void Begin(int64_t now, bool greeted = false);
  void Step(const LessonView& view);
  void Pause(int64_t now);
  void Resume(int64_t now);
  /// The next hint at once (the child asked for it).
  void Help() { help_ = true; }
  /// The present step is announced anew.
  void AnnounceAgain() { ToPhase(Phase::kAnnounce, "the step is to be said again"); }

  /// Whether an utterance that waits or is being said still holds.
  bool IsTrue(const Utterance& utterance, const LessonView& view) const;
  /// To be told when an utterance goes to the robot.
  void Spoken(const Utterance& utterance, int64_t now);

  Phase phase() const { return phase_; }
  int idle_level() const { return idle_level_; }
  int step() const { return step_; }
  int repairs() const { return repairs_; }
  /// Decisions since the last call: kind, subject and reason are set.
  std::vector<GuidanceEvent> TakeEvents() { return std::exchange(events_, {}); }

  PolicyMemory Save() const;
  /// @param greeted as in Begin
  void Restore(const PolicyMemory& memory, bool greeted);

 private:
  struct Correction {
    int times = 0;            // that it was said
    int64_t wrong_since = 0;  // us, since when it is sure; 0 it is not
    int64_t last = 0;         // us, when it was last said
  };
  void ToPhase(Phase phase, const std::string& reason);
  /// Where the step stands when nothing else is to be said.
  Phase Onwards() const { return announced_ ? Phase::kWait : Phase::kAnnounce; }
  void Answer(const LessonView& view);
  void NoteMovement(const LessonView& view);
  void NoteSight(const LessonView& view);
  void Praise(const LessonView& view);
  void Correct(const LessonView& view);
  void Repair(const LessonView& view);
  void Hedge(const LessonView& view);
  void Advance(const LessonView& view);
  void Hint(const LessonView& view);
  void Offer(const std::string& key, Priority priority, bool solicited, int connection, int part_a, int part_b,
             int64_t born);
  void OfferStep(const std::string& key, Priority priority, bool solicited, const LessonView& view);
  std::string IdleKey(int level, const LessonView& view) const;
  bool IsCorrectionDue(const BelievedJoint& wrong, const LessonView& view);
  std::string CorrectionKey(const BelievedJoint& wrong, const LessonView& view) const;
  const BelievedJoint* WorstWrong(const LessonView& view) const;
  bool Still(const LessonView& view) const;
  bool PartsStill(const LessonView& view) const;
  void Log(const std::string& kind, const std::string& subject, const std::string& reason, int part_a = -1,
           int part_b = -1, double probability = 0);

  ResponseOptions options_;
  SpeechQueue& speech_;
  Phase phase_ = Phase::kIntroduction;
  const char* introduction_ = "introduction";  // kind of phrase
  bool begun_ = false, introduced_ = false, announced_ = false, celebrated_ = false, help_ = false;
  int made_before_ = 0;  // connections made when the present step began
  int step_ = -1, idle_level_ = 0, repairs_ = 0;
  int64_t now_ = 0, last_movement_ = 0, last_part_movement_ = 0, hands_since_ = 0, quiet_ = 0, last_step_ = 0,
          hidden_since_ = 0, last_lost_ = 0, doubt_since_ = 0, last_hedge_ = 0;
  std::map<std::pair<int, int>, int64_t> to_praise_;  // pair -> us when it was decided
  std::map<JointName, Correction> corrections_;
  struct Said {
    int part_a = -1, part_b = -1;
    int64_t at = 0;
  } last_correction_;
  std::vector<GuidanceEvent> events_;
};

const char* ToString(Phase phase);

}  // namespace coach
