#include "services/assembly_reasoner/response_policy.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace coach {
namespace {

constexpr double kStraight = 15 * std::numbers::pi / 180;  // rad, below this two parts stand in line

double Seconds(int64_t from, int64_t to) { return static_cast<double>(to - from) * 1e-6; }

JointName NameOf(const BelievedJoint& joint) { return {joint.label, joint.part_a, joint.part_b}; }

/// Whether parts of these kinds are joined somewhere in the task.
bool ArePartners(const Task& task, int part_a, int part_b) {
  const std::pair types{task.parts[part_a].type, task.parts[part_b].type};
  return std::any_of(task.connections.begin(), task.connections.end(), [&](const Connection& c) {
    const std::pair joined{task.slots[c.slot_a].type, task.slots[c.slot_b].type};
    return joined == types || std::pair(joined.second, joined.first) == types;
  });
}

const char* Introduction(bool greeted) { return greeted ? "introduction_again" : "introduction"; }
bool IsIdle(const std::string& key) { return key.rfind("idle_", 0) == 0; }
bool IsWrong(const std::string& key) { return key.rfind("wrong", 0) == 0; }

}  // namespace

const char* ToString(Phase phase) {
  constexpr const char* kNames[] = {"introduction", "announce", "wait",          "correct", "wrong",
                                    "idle",         "away",     "tracking_lost", "paused",  "complete"};
  return kNames[static_cast<int>(phase)];
}

void ResponsePolicy::Log(const std::string& kind, const std::string& subject, const std::string& reason, int part_a,
                         int part_b, double probability) {
  GuidanceEvent e;
  e.utime = e.since = now_;
  e.kind = kind;
  e.subject = subject;
  e.reason = reason;
  e.part_a = part_a;
  e.part_b = part_b;
  e.probability = probability;
  events_.push_back(e);
}

void ResponsePolicy::ToPhase(Phase phase, const std::string& reason) {
  if (phase == Phase::kAnnounce) announced_ = false;
  if (phase != Phase::kIdle && phase != Phase::kAway) {
    idle_level_ = 0;
    quiet_ = 0;
  }
  if (phase == phase_) return;
  phase_ = phase;
  Log("phase", ToString(phase), reason);
}

void ResponsePolicy::Begin(int64_t now, bool greeted) {
  now_ = now;
  introduction_ = Introduction(greeted);
  begun_ = true;
  introduced_ = celebrated_ = false;
  step_ = -1;
  made_before_ = 0;
  to_praise_.clear();
  corrections_.clear();
  last_correction_ = {};
  speech_.Clear();
  ToPhase(Phase::kIntroduction, "the task begins");
}

void ResponsePolicy::Pause(int64_t now) {
  now_ = now;
  if (phase_ == Phase::kPaused) return;
  speech_.Clear();
  ToPhase(Phase::kPaused, "by the operator");
  Offer("pause", Priority::kOperator, true, -1, -1, -1, now);
}

void ResponsePolicy::Resume(int64_t now) {
  now_ = now;
  if (phase_ != Phase::kPaused) return;
  const Phase after = celebrated_ ? Phase::kComplete : introduced_ ? Phase::kAnnounce : Phase::kIntroduction;
  ToPhase(after, "by the operator");
  if (introduced_) Offer("resume", Priority::kOperator, true, -1, -1, -1, now);
}

void ResponsePolicy::Offer(const std::string& key, Priority priority, bool solicited, int connection, int part_a,
                           int part_b, int64_t born) {
  Utterance u;
  u.key = key;
  u.priority = priority;
  u.solicited = solicited;
  u.connection = connection;
  u.part_a = part_a;
  u.part_b = part_b;
  u.born = born;
  speech_.Offer(u);
}

/// An utterance about the present step, with the two parts that are nearest at hand.
void ResponsePolicy::OfferStep(const std::string& key, Priority priority, bool solicited, const LessonView& view) {
  std::vector<bool> unavailable;
  for (const PartEstimate& part : view.poses->parts)
    unavailable.push_back(part.status != PartStatus::kTracked && part.status != PartStatus::kOccluded);
  const auto [a, b] = PartsFor(view.reasoner->task(), view.reasoner->placement(), step_, unavailable);
  Offer(key, priority, solicited, step_, a, b, view.now);
}

void ResponsePolicy::NoteMovement(const LessonView& view) {
  const auto moves = [&](const Vector3& velocity) { return velocity.norm() > options_.moving_speed; };
  const auto& parts = view.poses->parts;
  const auto& foreign = view.poses->foreign;
  const bool part = std::any_of(parts.begin(), parts.end(), [&](const PartEstimate& p) {
    return p.status == PartStatus::kTracked && moves(p.velocity.head<3>());
  });
  const bool hand =
      std::any_of(foreign.begin(), foreign.end(), [&](const ForeignBlob& blob) { return moves(blob.velocity); });
  if (!hand) hands_since_ = 0;
  if (hand && hands_since_ == 0) hands_since_ = view.now;
  const bool hand_lasts = hand && Seconds(hands_since_, view.now) >= options_.hand_time;
  if (part || last_part_movement_ == 0) last_part_movement_ = view.now;
  if (part || hand_lasts || last_movement_ == 0) last_movement_ = view.now;
}

bool ResponsePolicy::Still(const LessonView& view) const {
  return Seconds(last_movement_, view.now) >= options_.still_time;
}

bool ResponsePolicy::PartsStill(const LessonView& view) const {
  return Seconds(last_part_movement_, view.now) >= options_.still_time;
}

void ResponsePolicy::NoteSight(const LessonView& view) {
  size_t unseen = 0;
  for (const PartEstimate& part : view.poses->parts)
    unseen += part.status == PartStatus::kLost || part.status == PartStatus::kAbsent;
  const bool lost = 2 * unseen > view.poses->parts.size();
  if (!lost) {
    hidden_since_ = 0;
    if (phase_ == Phase::kTrackingLost) ToPhase(Onwards(), "the parts are seen again");
    return;
  }
  if (hidden_since_ == 0) hidden_since_ = view.now;
  if (Seconds(hidden_since_, view.now) < options_.lost) return;
  ToPhase(Phase::kTrackingLost, std::to_string(unseen) + " parts can't be seen");
  if (last_lost_ != 0 && Seconds(last_lost_, view.now) < options_.lost_gap) return;
  Offer("lost", Priority::kReminder, false, -1, -1, -1, view.now);
}

void ResponsePolicy::Praise(const LessonView& view) {
  for (const ConnectionEvent& e : view.events) {
    const auto pair = std::minmax(e.part_a, e.part_b);
    if (e.type == "connect") {
      to_praise_[pair] = e.decided;
    } else {
      to_praise_.erase(pair);
    }
  }
  for (auto it = to_praise_.begin(); it != to_praise_.end();) {
    const auto& joints = view.reasoner->joints();
    const auto joint = std::find_if(joints.begin(), joints.end(), [&](const BelievedJoint& j) {
      return std::pair(j.part_a, j.part_b) == it->first && j.connection >= 0;
    });
    if (joint == joints.end()) {
      it = to_praise_.erase(it);
      continue;
    }
    const double p = view.reasoner->Probability(joint->connection, joint->part_a, joint->part_b);
    const bool due = view.reasoner->IsSeen(*joint) && Seconds(it->second, view.now) >= options_.praise_hold;
    if (p < options_.praise_probability || !due) {
      ++it;
      continue;
    }
    // The last one is celebrated, not praised.
    if (NextConnection(view.reasoner->task(), view.reasoner->placement(), view.skipped) >= 0) {
      ToPhase(Phase::kCorrect, "a right connection");
      Offer("praise", Priority::kCongratulatory, true, joint->connection, joint->part_a, joint->part_b, view.now);
    }
    it = to_praise_.erase(it);
  }
}

/// The wrong joint that has been said least often, of those that were seen.
const BelievedJoint* ResponsePolicy::WorstWrong(const LessonView& view) const {
  const BelievedJoint* worst = nullptr;
  int least = 1 << 20;
  for (const BelievedJoint& j : view.reasoner->joints()) {
    if (j.connection >= 0 || !view.reasoner->IsSeen(j)) continue;
    const auto said = corrections_.find(NameOf(j));
    const int times = said == corrections_.end() ? 0 : said->second.times;
    if (times < least) {
      worst = &j;
      least = times;
    }
  }
  return worst;
}

/// While a mistake waits for its correction nothing else is asked for. Once everything was said about it the child may
/// go on with it.
void ResponsePolicy::Correct(const LessonView& view) {
  const BelievedJoint* wrong = WorstWrong(view);
  if (wrong == nullptr || phase_ == Phase::kComplete) {
    if (phase_ == Phase::kWrong) ToPhase(Onwards(), "the wrong connection is undone");
    for (auto& [name, correction] : corrections_) correction.wrong_since = 0;
    return;
  }
  const int times = corrections_[NameOf(*wrong)].times;
  if (times > options_.correct_times) return;
  if (phase_ != Phase::kWrong) speech_.Withdraw(Priority::kExplanatory);
  ToPhase(Phase::kWrong, "a wrong connection");
  if (!IsCorrectionDue(*wrong, view)) return;
  const std::string key = times == options_.correct_times ? "wrong_last" : CorrectionKey(*wrong, view);
  if (!speech_.Waits(key)) {
    const bool listed = wrong->mistake >= 0;
    Log("act", listed ? view.reasoner->task().mistakes[wrong->mistake].name : "unknown", "to be corrected",
        wrong->part_a, wrong->part_b, view.reasoner->ProbabilityOf(wrong->part_a, wrong->part_b, wrong->label));
  }
  Offer(key, Priority::kCorrective, true, -1, wrong->part_a, wrong->part_b, view.now);
}

/// Sure for long enough, nothing in motion, not said just before; the child that asks for help need not wait.
bool ResponsePolicy::IsCorrectionDue(const BelievedJoint& wrong, const LessonView& view) {
  Correction& correction = corrections_[NameOf(wrong)];
  const double p = view.reasoner->ProbabilityOf(wrong.part_a, wrong.part_b, wrong.label);
  const double right = view.reasoner->BestRight(wrong.part_a, wrong.part_b, wrong.label);
  if (p < options_.correct_probability || p - right < options_.correct_margin) {
    correction.wrong_since = 0;
    return false;
  }
  if (correction.wrong_since == 0) correction.wrong_since = view.now;
  if (std::exchange(help_, false)) return true;
  const bool said_lately = correction.last != 0 && Seconds(correction.last, view.now) < options_.correct_gap;
  return Seconds(correction.wrong_since, view.now) >= options_.correct_hold && PartsStill(view) && !said_lately;
}

std::string ResponsePolicy::CorrectionKey(const BelievedJoint& wrong, const LessonView& view) const {
  if (view.reasoner->IsTurned(wrong)) return "wrong_turned";
  const bool partners = ArePartners(view.reasoner->task(), wrong.part_a, wrong.part_b);
  return wrong.mistake < 0 || partners ? "wrong_unknown" : "wrong";
}

/// A correction that turns out to have been wrong: the joint was right, or was not there, already when it was said.
void ResponsePolicy::Repair(const LessonView& view) {
  if (last_correction_.at == 0 || Seconds(last_correction_.at, view.now) > options_.repair_window) return;
  for (const ConnectionEvent& e : view.events) {
    const bool same = std::minmax(e.part_a, e.part_b) == std::minmax(last_correction_.part_a, last_correction_.part_b);
    if (!same || e.type == "wrong" || e.since >= last_correction_.at) continue;
    ++repairs_;
    Log("repair", e.name, "the correction is contradicted: " + e.type + " since before it was said", e.part_a, e.part_b,
        e.probability);
    Offer("repair", Priority::kCorrective, true, -1, e.part_a, e.part_b, view.now);
    last_correction_.at = 0;
    return;
  }
}

void ResponsePolicy::Hedge(const LessonView& view) {
  double doubt = 0;
  int part_a = -1, part_b = -1;
  const auto& joints = view.reasoner->joints();
  for (size_t i = 0; i < view.poses->pairs.size(); ++i) {
    const PairEvidence& pair = view.poses->pairs[i];
    const bool known = std::any_of(joints.begin(), joints.end(), [&](const BelievedJoint& j) {
      return j.part_a == pair.part_a && j.part_b == pair.part_b;
    });
    const double p = known ? 0 : 1 - view.reasoner->ProbabilityOf(pair.part_a, pair.part_b, kOpenLabel);
    if (p <= doubt) continue;
    doubt = p;
    part_a = pair.part_a;
    part_b = pair.part_b;
  }
  if (doubt < options_.hedge_low || !Still(view)) {
    doubt_since_ = 0;
    return;
  }
  if (doubt_since_ == 0) doubt_since_ = view.now;
  if (Seconds(doubt_since_, view.now) < options_.hedge_hold) return;
  if (last_hedge_ != 0 && Seconds(last_hedge_, view.now) < options_.hedge_gap) return;
  Offer("hedge", Priority::kReminder, false, -1, part_a, part_b, view.now);
}

/// Where the task stands: the next step is announced, or the end is.
void ResponsePolicy::Advance(const LessonView& view) {
  const int next = NextConnection(view.reasoner->task(), view.reasoner->placement(), view.skipped);
  if (next < 0) {
    step_ = -1;
    if (!to_praise_.empty()) return;
    ToPhase(Phase::kComplete, "every connection is made");
    if (!celebrated_) Offer("complete", Priority::kCongratulatory, true, -1, -1, -1, view.now);
    return;
  }
  if (phase_ == Phase::kComplete) ToPhase(Phase::kWait, "a connection came apart");
  celebrated_ = false;
  if (next != step_) {
    // A step that comes back because something came apart is not announced: no nagging. The hints remind of it.
    const auto& joints = view.reasoner->joints();
    const int made =
        static_cast<int>(std::count_if(joints.begin(), joints.end(), [](const auto& j) { return j.connection >= 0; }));
    const bool progress = made > made_before_ || phase_ == Phase::kAnnounce;
    step_ = next;
    made_before_ = made;
    if (progress && phase_ != Phase::kIntroduction) ToPhase(Phase::kAnnounce, "the next step");
  } else if (phase_ == Phase::kCorrect) {
    ToPhase(Onwards(), "on with the step");
  }
  if (phase_ == Phase::kIntroduction && !speech_.speaking(view.now)) ToPhase(Phase::kAnnounce, "introduced");
  if (phase_ != Phase::kAnnounce) return;
  // First the praise for what was made, then what comes next.
  const bool praise_first = !to_praise_.empty() || speech_.Waits("praise");
  if (!announced_ && !praise_first) OfferStep("step", Priority::kExplanatory, false, view);
  if (announced_ && !speech_.speaking(view.now)) ToPhase(Phase::kWait, "announced");
}

std::string ResponsePolicy::IdleKey(int level, const LessonView& view) const {
  constexpr std::array<const char*, 4> kKeys{"idle_1", "idle_2", "idle_3", "idle_4"};
  const std::string key = kKeys[static_cast<size_t>(std::clamp(level, 1, 4) - 1)];
  if (level != 3) return key;
  const Connection& c = view.reasoner->task().connections[step_];
  const Vector3 turn = LogRotation(c.X_AB.linear());
  if (turn.norm() < kStraight) return "idle_3_straight";
  // An angle is a help where the parts lie flat; what sits otherwise is shown as a whole.
  const bool flat = c.freedom.empty() && std::abs(turn.z()) > 0.94 * turn.norm();
  return flat ? key : kKeys[3];
}

void ResponsePolicy::Hint(const LessonView& view) {
  const bool waiting = phase_ == Phase::kWait || phase_ == Phase::kIdle || phase_ == Phase::kAway;
  if (!waiting || step_ < 0) {
    help_ = false;
    return;
  }
  const bool moving = !Still(view);
  if (moving && phase_ == Phase::kAway) ToPhase(Phase::kWait, "somebody is there again");
  if (!moving && !speech_.speaking(view.now)) quiet_ += view.now - last_step_;
  const int levels = static_cast<int>(options_.idle.size());
  const int level = std::min(idle_level_ + 1, levels);
  const double quiet = static_cast<double>(quiet_) * 1e-6;
  if (!help_ && idle_level_ == levels && quiet > options_.idle.back() + options_.away && phase_ != Phase::kAway)
    ToPhase(Phase::kAway, "nobody moves anything");
  const bool due = idle_level_ < levels && quiet >= options_.idle[static_cast<size_t>(level - 1)];
  if (!help_ && !due) return;
  const std::string key = IdleKey(level, view);
  if (!speech_.Waits(key))
    Log("act", key,
        help_ ? "the child asked for help" : "nothing has moved for " + std::to_string(static_cast<int>(quiet)) + " s");
  OfferStep(key, help_ ? Priority::kExplanatory : Priority::kReminder, help_, view);
  help_ = false;
}

void ResponsePolicy::Step(const LessonView& view) {
  now_ = view.now;
  NoteMovement(view);
  // A process that goes on with a lesson does not know when a correction was said: it may have been just now.
  if (last_step_ == 0) {
    for (auto& [name, correction] : corrections_) correction.last = view.now;
  }
  if (begun_ && phase_ != Phase::kPaused) {
    if (introduced_) {
      Answer(view);
    } else {
      Offer(introduction_, Priority::kExplanatory, true, -1, -1, -1, view.now);
    }
  }
  last_step_ = view.now;
}

void ResponsePolicy::Answer(const LessonView& view) {
  NoteSight(view);
  Repair(view);
  if (phase_ == Phase::kTrackingLost) {
    to_praise_.clear();
    return;
  }
  Praise(view);
  Advance(view);
  Correct(view);
  if (phase_ == Phase::kWait || phase_ == Phase::kIdle) Hedge(view);
  Hint(view);
}

bool ResponsePolicy::IsTrue(const Utterance& u, const LessonView& view) const {
  const auto& joints = view.reasoner->joints();
  const auto joined = [&](bool right) {
    return std::any_of(joints.begin(), joints.end(), [&](const BelievedJoint& j) {
      return std::minmax(j.part_a, j.part_b) == std::minmax(u.part_a, u.part_b) && (j.connection >= 0) == right;
    });
  };
  if (u.key == "step" || IsIdle(u.key)) return u.connection == step_ && phase_ != Phase::kPaused;
  if (u.key == "praise") return joined(true);
  if (IsWrong(u.key)) return joined(false) && phase_ != Phase::kPaused;
  if (u.key == "hedge") return !joined(true) && !joined(false);
  if (u.key == "complete") return phase_ == Phase::kComplete || phase_ == Phase::kPaused;
  if (u.key == "lost") return phase_ == Phase::kTrackingLost;
  return true;
}

void ResponsePolicy::Spoken(const Utterance& u, int64_t now) {
  if (u.key == introduction_) introduced_ = true;
  if (u.key == "step") announced_ = true;
  if (u.key == "complete") celebrated_ = true;
  if (u.key == "hedge") last_hedge_ = now;
  if (u.key == "lost") last_lost_ = now;
  if (IsIdle(u.key)) {
    idle_level_ = u.key[5] - '0';
    if (idle_level_ == 4) Log("act", "teacher", "the child needs the teacher's help");
    ToPhase(Phase::kIdle, "hint " + std::to_string(idle_level_));
  }
  if (IsWrong(u.key)) {
    last_correction_ = {u.part_a, u.part_b, now};
    for (auto& [name, correction] : corrections_) {
      if (std::minmax(name[1], name[2]) != std::minmax(u.part_a, u.part_b)) continue;
      correction.last = now;
      ++correction.times;
    }
    if (u.key == "wrong_last") Log("act", "teacher", "the same mistake was corrected three times");
  }
  if (u.key != "hedge" && !IsIdle(u.key)) quiet_ = 0;
}

PolicyMemory ResponsePolicy::Save() const {
  std::map<JointName, int> times;
  for (const auto& [name, correction] : corrections_) times[name] = correction.times;
  return {phase_, step_, made_before_, introduced_, announced_, celebrated_, idle_level_, times, repairs_};
}

void ResponsePolicy::Restore(const PolicyMemory& memory, bool greeted) {
  introduction_ = Introduction(greeted);
  begun_ = true;
  step_ = memory.step;
  made_before_ = memory.made_before;
  introduced_ = memory.introduced;
  announced_ = memory.announced;
  celebrated_ = memory.celebrated;
  for (const auto& [name, times] : memory.corrections) corrections_[name].times = times;
  repairs_ = memory.repairs;
  const bool holds = memory.phase == Phase::kPaused || memory.phase == Phase::kComplete;
  phase_ = holds ? memory.phase : introduced_ ? Onwards() : Phase::kIntroduction;
  idle_level_ = phase_ == Phase::kWait ? memory.idle_level : 0;
}

}  // namespace coach
