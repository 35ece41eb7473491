// Whole lessons with a simulated clock: a child made of a few rules, a robot that speaks as long as its sentences last.
#include "services/assembly_reasoner/lesson.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <random>
#include <set>

#include "common/assembly/task_file.h"
#include "services/assembly_reasoner/lesson_configuration.h"
#include "services/assembly_reasoner/lesson_file.h"

namespace coach {
namespace {

constexpr int64_t kFrame = 200000;  // us
const std::string kProject = COACH_SOURCE_DIR;

const Task& Rectangle() {
  static const Task task = LoadTask(kProject + "/deploy/tasks/rectangle_long_short.yaml", {.read_meshes = false});
  return task;
}
const std::map<std::string, PhraseBook>& Books() {
  static const auto books = LoadPhraseBooks(kProject + "/deploy/phrases");
  return books;
}

class Classroom {
 public:
  explicit Classroom(uint64_t seed, LessonOptions options = {}, std::vector<Task> tasks = {Rectangle()})
      : tasks_(std::move(tasks)), options_(options), random_(seed) {
    options_.seed = seed;
    NewLesson();
  }

  void Join(int a, int b, const Pose& X_AB) { joints_[{a, b}] = X_AB; }
  void JoinRight(int connection) {
    const Connection& c = Rectangle().connections[connection];
    Join(kPartInSlot[c.slot_a], kPartInSlot[c.slot_b], c.X_AB);
  }
  void Undo(int a, int b) { joints_.erase({a, b}); }
  void Build() {
    for (int c = 0; c < 4; ++c) JoinRight(c);
  }
  void TakeApart() { joints_.clear(); }
  bool Joined(int a, int b) const { return joints_.contains({a, b}) || joints_.contains({b, a}); }

  LessonOutput Operator(OperatorKind kind, const std::string& argument = "") {
    OperatorCommand command;
    command.id = ++operator_id_;
    command.kind = kind;
    command.argument = argument;
    LessonOutput out = lesson_->Handle(command);
    Note(out);
    return out;
  }
  /// A new process takes over from the state file.
  void Restart() {
    const std::string state = ToJson(lesson_->Save());
    NewLesson();
    lesson_->Restore(LessonMemoryFromJson(state));
    robot_id_ = 0;
    restarted_ = now_;
  }
  void Run(double seconds) {
    const int before = refused;
    RunOn(seconds);
    EXPECT_EQ(refused, before);
  }
  /// The same where poses may be refused, as in the second after a change of task.
  void RunOn(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / 0.2); ++i) Frame();
  }

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
  int64_t restarted() const { return restarted_; }
  const AssemblyState& state() const { return state_; }
  std::mt19937_64& random() { return random_; }
  std::vector<std::string> Keys() const {
    std::vector<std::string> keys;
    for (const Said& s : said) keys.push_back(s.command.phrase_key);
    return keys;
  }
  int Count(const std::string& key) const {
    const auto keys = Keys();
    return static_cast<int>(std::count(keys.begin(), keys.end(), key));
  }
  const GuidanceEvent* Find(const std::string& kind) const {
    for (const GuidanceEvent& e : events) {
      if (e.kind == kind) return &e;
    }
    return nullptr;
  }
  const std::map<std::pair<int, int>, Pose>& joints() const { return joints_; }

 private:
  static constexpr std::array<int, 4> kPartInSlot{0, 2, 1, 3};  // left, front, right, back

  void NewLesson() { lesson_ = std::make_unique<Lesson>(tasks_, Books(), options_, "TEST"); }

  void Frame() {
    now_ += kFrame;
    if (robot_id_ != 0 && robot_reports && now_ >= robot_until_) {
      RobotStatus status;
      status.session = lesson_->session();
      status.command_id = robot_id_;
      status.state = ActState::kDone;
      robot_id_ = 0;
      lesson_->Handle(status);
    }
    const LessonOutput out = lesson_->Step(Poses());
    if (!out.accepted) ++refused;
    Note(out);
  }

  PartPoses Poses() {
    std::normal_distribution<double> noise(0, 0.0002);
    const auto shake = [&] {
      Vector6 xi;
      for (int i = 0; i < 6; ++i) xi[i] = (i < 3 ? 1 : 5) * noise(random_);
      return xi;
    };
    PartPoses poses;
    poses.utime = now_;
    poses.foreign.push_back({.velocity = Vector3(hand_speed(now_), 0, 0)});
    std::vector<Pose> X(4, Pose::Identity());
    std::vector<bool> placed(4, false);
    for (int p = 0; p < 4; ++p) {
      if (placed[p]) continue;
      X[p].translation() = Vector3(0.4 * p, 0, 0);
      placed[p] = true;
      for (int round = 0; round < 4; ++round) {
        for (const auto& [pair, X_AB] : joints_) {
          if (placed[pair.first] && !placed[pair.second]) X[pair.second] = X[pair.first] * X_AB;
          if (placed[pair.second] && !placed[pair.first]) X[pair.first] = X[pair.second] * X_AB.inverse();
          if (placed[pair.first] || placed[pair.second]) placed[pair.first] = placed[pair.second] = true;
        }
      }
    }
    for (int p = 0; p < 4; ++p) {
      PartEstimate part;
      part.X_TP = Perturb(X[p], shake());
      part.covariance = Matrix6::Identity() * 4e-8;
      part.visible_fraction = hidden ? 0 : 0.9;
      part.status = hidden ? PartStatus::kLost : PartStatus::kTracked;
      if (moving) part.velocity[0] = 0.2;
      poses.parts.push_back(part);
    }
    for (const auto& [pair, X_AB] : joints_) {
      if (hidden) break;
      PairEvidence e;
      const bool in_order = pair.first < pair.second;
      e.part_a = std::min(pair.first, pair.second);
      e.part_b = std::max(pair.first, pair.second);
      e.X_AB = Perturb(in_order ? X_AB : X_AB.inverse(), shake());
      e.covariance = Matrix6::Identity() * 1e-7;
      e.visible_fraction = {0.9, 0.9};
      poses.pairs.push_back(e);
    }
    return poses;
  }

  void Note(const LessonOutput& out) {
    state_ = out.state;
    events.insert(events.end(), out.events.begin(), out.events.end());
    for (const RobotCommand& command : out.commands) {
      if (command.kind == ActKind::kCancel) robot_until_ = now_;  // the robot falls silent and reports it
      if (command.kind == ActKind::kStop) robot_id_ = 0;
      if (command.kind != ActKind::kAct) continue;
      const bool operators = command.priority >= Priority::kOperator;
      EXPECT_TRUE(operators || robot_id_ == 0 || !robot_reports) << "two sentences at once: " << command.text;
      robot_id_ = command.id;
      robot_until_ = now_ + static_cast<int64_t>((0.5 + CountCharacters(command.text) / 14.0) * 1e6);
      said.push_back({command, now_, out.state});
    }
  }

  std::vector<Task> tasks_;
  LessonOptions options_;
  std::mt19937_64 random_;
  std::unique_ptr<Lesson> lesson_;
  std::map<std::pair<int, int>, Pose> joints_;
  AssemblyState state_;
  int64_t now_ = 1000000, robot_until_ = 0, robot_id_ = 0, operator_id_ = 100, restarted_ = 0;
};

TEST(Lesson, FromGreetingToTheLastPraise) {
  Classroom room(1);
  room.Run(2);
  EXPECT_TRUE(room.said.empty()) << "nobody has started the lesson";
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  ASSERT_THAT(room.Keys(), testing::ElementsAre("introduction", "step"));
  EXPECT_EQ(room.state().phase, Phase::kWait);
  for (int c = 0; c < 3; ++c) {
    if (c == 2) room.JoinRight(3);  // the ring closes by itself
    room.JoinRight(c);
    room.Run(12);
  }
  EXPECT_EQ(room.state().phase, Phase::kComplete);
  EXPECT_EQ(room.state().made, 4);
  EXPECT_EQ(room.Count("complete"), 1);
  EXPECT_EQ(room.Count("praise"), 2);
  EXPECT_EQ(room.Count("introduction"), 1);
}

TEST(Lesson, TheLastPraiseIsSaidEvenIfTheRobotIsBusyForLong) {
  Classroom room(1);
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.robot_reports = false;  // and is taken to speak for its patience
  room.Operator(OperatorKind::kSay, std::string(120, 'a'));
  room.Build();
  room.Run(8);
  EXPECT_EQ(room.Count("complete"), 0);
  room.Run(10);
  EXPECT_EQ(room.Count("complete"), 1);
}

TEST(Lesson, StartedBeforeTheFirstPictureItBeginsWithIt) {
  Classroom room(1);
  room.Operator(OperatorKind::kStart);
  room.Wait(1'700'000'000.0);  // a live camera's time is that of the epoch
  room.Run(20);
  EXPECT_THAT(room.Keys(), testing::ElementsAre("introduction", "step"));
}

TEST(Lesson, HintsClimbTheLadderAndTheClockStopsWhileSomethingMoves) {
  Classroom room(2);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.moving = true;
  room.Run(60);
  EXPECT_EQ(room.Count("idle_1"), 0);
  room.moving = false;
  room.Run(130);
  EXPECT_THAT(room.Keys(), testing::ElementsAre("introduction", "step", "idle_1", "idle_2", "idle_3", "idle_4"));
  EXPECT_EQ(room.state().phase, Phase::kIdle);
  room.Run(120);
  EXPECT_EQ(room.state().phase, Phase::kAway);
  room.moving = true;
  room.Run(1);
  EXPECT_EQ(room.state().phase, Phase::kWait);
}

TEST(Lesson, RestingArmsThatJitterHoldNothingUp) {
  Classroom room(12);
  room.hand_speed = [](int64_t now) { return now / 200000 % 3 == 0 ? 0.2 : 0.01; };
  room.Operator(OperatorKind::kStart);
  room.Run(45);
  EXPECT_EQ(room.Count("idle_1"), 1);
  room.Join(0, 1, Rectangle().mistakes[0].X_AB);
  room.Run(10);
  EXPECT_EQ(room.Count("wrong"), 1);
}

TEST(Lesson, MovingHandsHoldHintsUpButNoCorrection) {
  Classroom room(13);
  room.hand_speed = [](int64_t) { return 0.3; };
  room.Operator(OperatorKind::kStart);
  room.Run(60);
  EXPECT_EQ(room.Count("idle_1"), 0);
  room.Join(0, 1, Rectangle().mistakes[0].X_AB);
  room.Run(10);
  EXPECT_EQ(room.Count("wrong"), 1);
}

TEST(Lesson, HelpIsGivenAtOnce) {
  Classroom room(3);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.Operator(OperatorKind::kHelp);
  room.Run(2);
  EXPECT_EQ(room.said.back().command.phrase_key, "idle_1");
  EXPECT_LT(room.now() - room.said.back().at, 2000001);
}

TEST(Lesson, AMistakeIsCorrectedThreeTimesThenTheWholeHelpThenSilence) {
  Classroom room(4);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  const Mistake& m = Rectangle().mistakes[0];  // long on long
  room.Join(0, 1, m.X_AB);
  room.Run(120);
  EXPECT_EQ(room.Count("wrong"), 3);
  EXPECT_EQ(room.Count("wrong_last"), 1);
  EXPECT_EQ(room.state().phase, Phase::kWrong);
  int64_t last = 0;
  for (const auto& s : room.said) {
    if (s.command.priority != Priority::kCorrective) continue;
    EXPECT_TRUE(last == 0 || s.at - last >= 12000000);
    last = s.at;
  }
  room.Undo(0, 1);
  room.Run(3);
  EXPECT_NE(room.state().phase, Phase::kWrong);
}

TEST(Lesson, ATurnedPieceIsNamedAsSuch) {
  Classroom room(5);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.JoinRight(0);
  room.Run(10);
  const auto& c = Rectangle().connections[4];  // mirrored_1 between the two parts that are left
  room.Join(1, 3, c.X_AB);
  room.Run(10);
  EXPECT_EQ(room.Count("wrong_turned"), 1);
}

TEST(Lesson, TwoThatBelongTogetherAreNotSaidToBelongElsewhere) {
  const auto& mistakes = Rectangle().mistakes;
  const auto line = std::find_if(mistakes.begin(), mistakes.end(),
                                 [](const Mistake& m) { return m.type_a != m.type_b && m.name.rfind("line", 0) == 0; });
  ASSERT_NE(line, mistakes.end());
  Classroom room(5);
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.Join(0, 2, line->X_AB);
  room.Run(10);
  EXPECT_EQ(room.Count("wrong_unknown"), 1);
  EXPECT_EQ(room.Count("wrong"), 0);
}

TEST(Lesson, ARestartSaysNothingTwiceAndLosesNothing) {
  Classroom room(6);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.JoinRight(0);
  room.Run(15);
  const size_t before = room.said.size();
  room.Restart();
  room.Run(5);
  EXPECT_EQ(room.said.size(), before);
  EXPECT_EQ(room.state().made, 1);
  EXPECT_EQ(room.state().session, 101);
  room.JoinRight(1);
  room.Run(3);
  EXPECT_EQ(room.said.back().command.phrase_key, "praise");
}

TEST(Lesson, OperatorCommandsInTheWrongPhaseAreRefusedWithAnEvent) {
  Classroom room(7);
  for (const auto kind : {OperatorKind::kPause, OperatorKind::kResume, OperatorKind::kSkip, OperatorKind::kHelp,
                          OperatorKind::kRepeat, OperatorKind::kMarkDone}) {
    const LessonOutput out = room.Operator(kind);
    ASSERT_FALSE(out.events.empty());
    EXPECT_THAT(out.events.back().reason, testing::StartsWith("refused"));
    EXPECT_TRUE(out.commands.empty());
  }
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  EXPECT_THAT(room.Operator(OperatorKind::kStart).events.back().reason, testing::HasSubstr("refused"));
  EXPECT_THAT(room.Operator(OperatorKind::kLanguage, "xx").events.back().reason, testing::HasSubstr("refused"));
  EXPECT_THAT(room.Operator(OperatorKind::kChooseTask, "boat").events.back().reason, testing::HasSubstr("refused"));
  EXPECT_THAT(room.Operator(OperatorKind::kMarkDone, "corner_9").events.back().reason, testing::HasSubstr("refused"));
}

TEST(Lesson, OperatorMarksSkipsPausesSpeaks) {
  Classroom room(8);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.Operator(OperatorKind::kMarkDone, "corner_1");
  room.Run(2);
  EXPECT_EQ(room.state().made, 1);
  room.Operator(OperatorKind::kMarkUndone, "corner_1");
  room.Run(2);
  EXPECT_EQ(room.state().made, 0);
  const int step = room.state().step;
  room.Operator(OperatorKind::kSkip);
  room.Run(1);
  EXPECT_NE(room.state().step, step);
  room.Operator(OperatorKind::kPause);
  const size_t before = room.said.size();
  room.Run(200);
  EXPECT_LE(room.said.size(), before + 1) << "a pause is quiet";
  EXPECT_EQ(room.state().phase, Phase::kPaused);
  room.Operator(OperatorKind::kSay, "Bravo");
  EXPECT_EQ(room.said.back().command.text, "Bravo");
  room.Operator(OperatorKind::kLanguage, "el");
  room.Operator(OperatorKind::kResume);
  room.Run(15);
  EXPECT_EQ(room.said.back().command.language, "el");
  EXPECT_EQ(room.Operator(OperatorKind::kStop).commands.back().kind, ActKind::kStop);
}

TEST(Lesson, PartsOutOfSightAreSaidOnceAndNothingElse) {
  Classroom room(9);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.hidden = true;
  room.Run(40);
  EXPECT_EQ(room.state().phase, Phase::kTrackingLost);
  EXPECT_EQ(room.Count("lost"), 1);
  room.hidden = false;
  room.Run(2);
  EXPECT_EQ(room.state().phase, Phase::kWait);
}

/// A lesson of three rectangles one after the other, the second and third called `second` and `third`; a fourth task
/// that the station has, but that is not of the lesson.
std::vector<Task> FourTasks() {
  std::vector<Task> tasks(4, Rectangle());
  for (size_t i = 1; i < 4; ++i) tasks[i].name = std::array{"second", "third", "fourth"}[i - 1];
  return tasks;
}
LessonOptions ThreeInARow() {
  LessonOptions options;
  options.in_a_row = 3;
  options.task_pause = 20;
  return options;
}
/// Up to the moment when the lesson has said that another task follows.
void BuildAndRest(Classroom& room) {
  room.RunOn(12);
  room.Build();
  for (int i = 0; i < 100 && (room.said.empty() || room.said.back().command.phrase_key != "next_task"); ++i)
    room.Run(0.2);
  ASSERT_EQ(room.Keys().back(), "next_task");
}

TEST(Lesson, TheNextTaskIsIntroducedByItselfAfterThePause) {
  Classroom room(20, ThreeInARow(), FourTasks());
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  BuildAndRest(room);
  EXPECT_EQ(room.Count("complete"), 1);
  EXPECT_EQ(room.state().phase, Phase::kComplete);
  const int64_t told = room.said.back().at;
  const size_t said = room.said.size();
  room.Run(5);
  room.TakeApart();  // which is not a step back: nothing is said about it
  room.Run(15);
  EXPECT_EQ(room.said.size(), said);
  room.RunOn(10);
  ASSERT_GT(room.said.size(), said);
  EXPECT_EQ(room.said[said].command.phrase_key, "introduction_again") << "nobody is greeted twice";
  EXPECT_NEAR(static_cast<double>(room.said[said].at - told) * 1e-6, 20 + 4, 3) << "pause after the sentence";
  EXPECT_EQ(room.state().task, "second");
  EXPECT_EQ(room.state().session, 101);
  ASSERT_NE(room.Find("session"), nullptr);
  EXPECT_EQ(room.Find("session")->subject, "next_task");
  EXPECT_EQ(room.Find("session")->reason, "second");
  room.Run(10);
  EXPECT_EQ(room.Keys().back(), "step");
}

TEST(Lesson, TheLastTaskOfALessonIsFollowedByNone) {
  Classroom room(21, ThreeInARow(), FourTasks());
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  for (int task = 0; task < 2; ++task) {
    BuildAndRest(room);
    room.TakeApart();
    room.RunOn(30);
  }
  EXPECT_EQ(room.state().task, "third");
  room.Build();
  room.Run(60);
  EXPECT_EQ(room.Keys().back(), "complete");
  EXPECT_EQ(room.state().task, "third");
  EXPECT_EQ(room.Count("introduction"), 1);
  EXPECT_EQ(room.Count("introduction_again"), 2);
  EXPECT_EQ(room.Count("next_task"), 2);
}

TEST(Lesson, PosesOfTheFormerTaskAreNotTakenForThoseOfTheNext) {
  Classroom room(22, ThreeInARow(), FourTasks());
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  BuildAndRest(room);
  room.Run(5);
  room.Operator(OperatorKind::kSkip);
  EXPECT_EQ(room.state().task, "second");
  const size_t said = room.said.size();
  room.RunOn(0.8);  // the tracker still sends the finished rectangle
  EXPECT_EQ(room.refused, 4);
  EXPECT_EQ(room.state().made, 0);
  EXPECT_EQ(room.said.size(), said);
  room.TakeApart();
  room.RunOn(3);
  EXPECT_EQ(room.Keys().back(), "introduction_again");
  EXPECT_EQ(room.state().made, 0);
}

TEST(Lesson, TheOperatorOverrulesThePauseBetweenTasks) {
  for (const OperatorKind kind : {OperatorKind::kStart, OperatorKind::kSkip}) {
    Classroom room(23, ThreeInARow(), FourTasks());
    room.Run(1);
    room.Operator(OperatorKind::kStart);
    BuildAndRest(room);
    room.TakeApart();
    room.Operator(kind);
    EXPECT_EQ(room.state().task, "second") << "at once";
    room.RunOn(2);
    EXPECT_EQ(room.Keys().back(), "introduction_again");
    EXPECT_EQ(room.state().session, 101) << "the same lesson";
  }
  Classroom room(24, ThreeInARow(), FourTasks());
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  BuildAndRest(room);
  EXPECT_THAT(room.Operator(OperatorKind::kHelp).events.back().reason, testing::StartsWith("refused"));
  room.Operator(OperatorKind::kPause);
  room.RunOn(100);
  EXPECT_EQ(room.state().task, Rectangle().name);
  EXPECT_EQ(room.state().phase, Phase::kPaused);
  room.Operator(OperatorKind::kResume);
  room.Run(15);
  EXPECT_EQ(room.state().task, Rectangle().name) << "the pause begins anew";
  room.TakeApart();
  room.Operator(OperatorKind::kChooseTask, "fourth");
  room.RunOn(15);
  EXPECT_EQ(room.state().task, "fourth");
  EXPECT_EQ(room.Keys().back(), "step");
  room.Build();
  room.Run(60);
  EXPECT_EQ(room.state().task, "fourth") << "no task of the lesson follows one that is not of it";
  EXPECT_EQ(room.Count("next_task"), 1);
}

TEST(Lesson, ARestartInThePauseBetweenTasksGoesOnToTheNext) {
  Classroom room(25, ThreeInARow(), FourTasks());
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  BuildAndRest(room);
  room.Run(10);
  const size_t said = room.said.size();
  room.Restart();
  room.TakeApart();
  room.Run(15);
  EXPECT_EQ(room.said.size(), said);
  room.RunOn(15);
  EXPECT_EQ(room.state().task, "second");
  ASSERT_GT(room.said.size(), said);
  EXPECT_EQ(room.said[said].command.phrase_key, "introduction_again");
}

/// One random session; the rules of speech are checked over everything that was said.
void RandomSession(uint64_t seed, int& utterances) {
  Classroom room(seed);
  auto& random = room.random();
  const auto chance = [&](double p) { return std::uniform_real_distribution<double>(0, 1)(random) < p; };
  room.robot_reports = chance(0.8);
  room.Run(0.4);
  room.Operator(OperatorKind::kStart);
  std::map<std::pair<int, int>, int> wrong;
  for (int action = 0; action < 14; ++action) {
    const double dice = std::uniform_real_distribution<double>(0, 1)(random);
    if (dice < 0.4) {
      room.JoinRight(static_cast<int>(random() % 4));
    } else if (dice < 0.55 && wrong.empty() && room.joints().empty()) {
      const Mistake& m = Rectangle().mistakes[random() % 3];
      room.Join(0, 1, m.X_AB);
      wrong[{0, 1}] = 1;
    } else if (dice < 0.75 && !wrong.empty()) {
      room.Undo(0, 1);
      wrong.clear();
    } else if (dice < 0.8 && !room.joints().empty()) {
      const auto pair = room.joints().begin()->first;
      room.Undo(pair.first, pair.second);
      wrong.erase(pair);
    } else if (dice < 0.85) {
      room.hidden = !room.hidden;
    } else if (dice < 0.9) {
      room.Restart();
    } else {
      const auto kind = static_cast<OperatorKind>(random() % 14);
      room.Operator(kind, chance(0.5) ? "corner_2" : "el");
    }
    room.moving = chance(0.4);
    room.RunOn(std::uniform_real_distribution<double>(0.5, chance(0.2) ? 60 : 12)(random));
  }
  const std::set<std::string> unsolicited{"step", "hedge", "lost"};
  int64_t last_unsolicited = 0, last_event = 0, last_command = 0, last_wrong = 0;
  std::map<std::string, std::vector<int>> wordings;
  for (const auto& s : room.said) {
    const RobotCommand& c = s.command;
    ++utterances;
    ASSERT_GT(c.id, last_command);
    last_command = c.id;
    ASSERT_FALSE(c.text.empty());
    ASSERT_LE(c.text.size(), 400u);
    ASSERT_EQ(c.text.find_first_of("{}[]|"), std::string::npos) << c.text;
    if (unsolicited.contains(c.phrase_key)) {
      // The clock of the gap starts anew in a new process.
      ASSERT_TRUE(last_unsolicited == 0 || s.at - last_unsolicited >= 6000000 || room.restarted() > last_unsolicited)
          << c.phrase_key;
      last_unsolicited = s.at;
    }
    if (c.phrase_key.rfind("wrong", 0) == 0) {
      const bool still_wrong = std::any_of(s.state.connections.begin(), s.state.connections.end(),
                                           [](const ConnectionState& x) { return x.connection < 0; });
      ASSERT_TRUE(still_wrong) << "a correction of what is right: " << c.text;
      ASSERT_TRUE(last_wrong == 0 || s.at - last_wrong >= 12000000 || room.restarted() > last_wrong ||
                  c.phrase_key != "wrong");
      last_wrong = s.at;
    }
    if (c.phrase_key == "praise") {
      ASSERT_GT(s.state.made, 0);
    }
    if (c.phrase_key == "operator" || room.restarted() > 0) continue;
    auto& last = wordings[c.language + c.phrase_key];
    const auto from = last.size() > 3 ? last.end() - 3 : last.begin();
    ASSERT_EQ(std::find(from, last.end(), c.wording), last.end()) << "a wording again within three";
    last.push_back(c.wording);
  }
  for (const GuidanceEvent& e : room.events) {
    ASSERT_GT(e.id, last_event);
    last_event = e.id;
  }
}

TEST(Lesson, SpeechRulesHoldInRandomSessions) {
  int utterances = 0;
  for (uint64_t seed = 1; seed <= 150 && !testing::Test::HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    RandomSession(seed, utterances);
  }
  EXPECT_GT(utterances, 1000);
}

TEST(Lesson, TheSameSessionTwiceIsTheSame) {
  const auto texts = [] {
    Classroom room(11);
    room.Operator(OperatorKind::kStart);
    room.Run(20);
    room.JoinRight(0);
    room.Run(60);
    std::vector<std::string> out;
    for (const auto& s : room.said) out.push_back(s.command.text);
    return out;
  };
  EXPECT_EQ(texts(), texts());
}

}  // namespace
}  // namespace coach
