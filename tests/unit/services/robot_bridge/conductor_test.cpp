#include "services/robot_bridge/conductor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "services/robot_bridge/robot_options.h"
#include "services/robot_bridge/speech_text.h"

namespace coach {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

constexpr int64_t kSecond = 1000000, kTick = 20000;

/// A robot that obeys, unless told to be unable.
class FakeRobot : public BackEnd {
 public:
  std::string name() const override { return "fake"; }
  bool physical() const override { return is_physical; }
  std::vector<BackEndEvent> Poll(int64_t time) override {
    now = time;
    std::vector<BackEndEvent> events = std::move(pending);
    pending.clear();
    if (speaking && !hangs && now >= speech_end) {
      events.push_back({BackEndEvent::Kind::kSpeechDone, speaking->id, ""});
      speaking.reset();
    }
    return events;
  }
  BackEndState State() const override { return {connected, "", 0.5}; }
  void Say(const SpeechOrder& speech) override {
    EXPECT_FALSE(speaking) << "two sentences at once";
    speaking = speech;
    speech_end = now + static_cast<int64_t>(SpeakingTime(speech.text) * 1e6);
    said.push_back(speech.text);
    calls.push_back("say");
  }
  void Silence() override { speaking.reset(), calls.push_back("silence"); }
  void Move(const JointPath& path) override { calls.push_back(path.moves[0] || path.moves[1] ? "head" : "arm"); }
  void Freeze() override { calls.push_back("freeze"); }
  void SetEyes(const EyeColour& colour) override { calls.push_back("eyes " + HexOf(colour)); }
  void Rest() override { calls.push_back("rest"); }
  void Wake() override { calls.push_back("wake"); }
  void SetVolume(double) override {}

  bool is_physical = true, connected = true, hangs = false;
  int64_t now = 0, speech_end = 0;
  std::optional<SpeechOrder> speaking;
  std::vector<std::string> said, calls;
  std::vector<BackEndEvent> pending;
};

class ConductorTest : public testing::Test {
 protected:
  ConductorTest() {
    options.X_TR = MakePose(ExpRotation(Vector3(0, 0, -std::numbers::pi / 2)), Vector3(0, 0.5, 0.08));
    conductor.emplace(options, robot);
    Run(0.1);
  }
  void Run(double seconds) {
    for (const int64_t end = now + static_cast<int64_t>(seconds * 1e6); now < end; now += kTick) {
      if (scene_seen) conductor->SetScene(scene, now);
      conductor->Step(now);
      for (const ActChange& change : conductor->TakeChanges()) {
        if (!change.repeated) changes.push_back(change);
      }
    }
  }
  RobotCommand Act(int64_t id, const std::string& text) {
    RobotCommand command;
    command.id = id;
    command.session = 1;
    command.text = text;
    command.valid_for_us = 4 * kSecond;
    return command;
  }
  ActState Last(int64_t id) const {
    ActState state = ActState::kNone;
    for (const ActChange& change : changes) state = change.id == id ? change.state : state;
    return state;
  }
  std::string Reason(int64_t id) const {
    std::string reason;
    for (const ActChange& change : changes) reason = change.id == id ? change.reason : reason;
    return reason;
  }

  ConductorOptions options;
  FakeRobot robot;
  std::optional<Conductor> conductor;
  TableScene scene;
  bool scene_seen = true;
  int64_t now = 10 * kSecond;
  std::vector<ActChange> changes;
};

TEST_F(ConductorTest, ActSpeaksPointsLooksAndIsDone) {
  RobotCommand act = Act(1, "Put the green one here.");
  act.point_target = Vector3(0.1, 0.05, 0.02);
  act.look_target = act.point_target;
  act.eye_colour = "green";
  conductor->Offer(act, now);
  Run(1);
  EXPECT_THAT(robot.calls, Contains("say"));
  EXPECT_THAT(robot.calls, Contains("arm"));
  EXPECT_THAT(robot.calls, Contains("head"));
  EXPECT_THAT(robot.calls, Contains("eyes #32af50"));
  Run(6);
  EXPECT_EQ(Last(1), ActState::kDone);
  EXPECT_TRUE(conductor->body().arms_down());
  for (size_t j = 0; j < 2; ++j) EXPECT_NEAR(conductor->body().angles()[j], 0, 1e-9);  // looks straight again
}

TEST_F(ConductorTest, ArmIsHeldUpThreeSecondsAtMost) {
  RobotCommand act = Act(1, std::string(200, 'a'));  // a sentence of 15 s
  act.point_target = Vector3(0.1, 0.05, 0.02);
  conductor->Offer(act, now);
  Run(2);
  EXPECT_FALSE(conductor->body().arms_down());
  Run(4.5);
  EXPECT_TRUE(conductor->body().arms_down());
  EXPECT_EQ(Last(1), ActState::kStarted);
}

TEST_F(ConductorTest, StopActsBeforeItReturnsAndTheArmStaysWhereItIs) {
  RobotCommand act = Act(1, "Put the green one here, please, and look at it well.");
  act.point_target = Vector3(0.1, 0.05, 0.02);
  conductor->Offer(act, now);
  conductor->Offer(Act(2, "more"), now);
  Run(0.3);
  robot.calls.clear();
  RobotCommand stop = Act(3, "");
  stop.kind = ActKind::kStop;
  stop.priority = Priority::kStop;
  conductor->Offer(stop, now);
  EXPECT_THAT(robot.calls, testing::ElementsAre("silence", "freeze"));
  const JointAngles held = conductor->body().angles();
  Run(5);
  EXPECT_EQ(conductor->body().angles(), held);
  EXPECT_EQ(Last(1), ActState::kInterrupted);
  EXPECT_EQ(Last(2), ActState::kInterrupted);
  EXPECT_EQ(Last(3), ActState::kDone);
  EXPECT_THAT(robot.calls, Not(Contains("rest")));
  conductor->Offer(Act(4, "On we go."), now);  // the next act takes the arm down
  Run(4);
  EXPECT_EQ(Last(4), ActState::kDone);
  EXPECT_TRUE(conductor->body().arms_down());
}

TEST_F(ConductorTest, HandInTheWayKeepsTheArmDownButNotTheSentence) {
  ForeignBlob hand;
  hand.centre = Vector3(0.05, 0.3, 0.1);
  hand.radius = 0.06;
  scene.foreign = {hand};
  RobotCommand act = Act(1, "Put it here.");
  act.point_target = Vector3(0.1, 0.05, 0.02);
  conductor->Offer(act, now);
  Run(5);
  EXPECT_THAT(robot.calls, Not(Contains("arm")));
  EXPECT_EQ(robot.said.size(), 1u);
  EXPECT_EQ(Last(1), ActState::kDone);
  EXPECT_THAT(Reason(1), HasSubstr("hand"));
}

TEST_F(ConductorTest, HandThatComesNearStopsTheMovingArm) {
  RobotCommand act = Act(1, "Put it here.");
  act.point_target = Vector3(0.1, 0.05, 0.02);
  conductor->Offer(act, now);
  Run(0.2);
  ASSERT_THAT(robot.calls, Contains("arm"));
  ForeignBlob hand;
  hand.centre = Vector3(0.05, 0.3, 0.1);
  hand.radius = 0.06;
  scene.foreign = {hand};
  Run(0.1);
  EXPECT_THAT(robot.calls, Contains("freeze"));
  scene.foreign.clear();
  Run(5);
  EXPECT_TRUE(conductor->body().arms_down());
}

TEST_F(ConductorTest, MovingRobotDoesNotPointBlindly) {
  scene_seen = false;
  Run(2);
  RobotCommand act = Act(1, "Put it here.");
  act.point_target = Vector3(0.1, 0.05, 0.02);
  conductor->Offer(act, now);
  Run(5);
  EXPECT_THAT(robot.calls, Not(Contains("arm")));
  EXPECT_EQ(Last(1), ActState::kDone);
}

TEST_F(ConductorTest, TargetBehindTheRobotIsSaidButNotPointedAt) {
  RobotCommand act = Act(1, "There.");
  act.point_target = Vector3(0, 1, 0);
  act.look_target = act.point_target;
  conductor->Offer(act, now);
  Run(0.1);
  EXPECT_TRUE(conductor->body().gaze_clamped());
  EXPECT_TRUE(conductor->body().point_clamped());
  Run(4);
  EXPECT_EQ(Last(1), ActState::kDone);
  EXPECT_THAT(Reason(1), HasSubstr("behind"));
}

TEST_F(ConductorTest, LookThenSayWaitsForTheHead) {
  RobotCommand act = Act(1, "Look there.");
  act.look_target = Vector3(0.4, 0.3, 0.02);
  act.order = ActOrder::kLookThenSay;
  conductor->Offer(act, now);
  Run(0.1);
  EXPECT_TRUE(robot.said.empty());
  Run(1.6);
  EXPECT_EQ(robot.said.size(), 1u);
}

TEST_F(ConductorTest, SentenceThatNeverEndsFailsAndTheNextOneIsSaid) {
  robot.hangs = true;
  conductor->Offer(Act(1, "Hm."), now);
  Run(1);
  robot.hangs = false;
  robot.speech_end = now + 1000 * kSecond;
  RobotCommand next = Act(2, "Well.");
  next.valid_for_us = 60 * kSecond;
  conductor->Offer(next, now);
  Run(10);
  EXPECT_EQ(Last(1), ActState::kFailed);
  EXPECT_EQ(Last(2), ActState::kDone);
}

TEST_F(ConductorTest, LostConnectionFailsTheActKeepsTheQueueAndSaysNothingTwice) {
  conductor->Offer(Act(1, "One sentence that is long enough to be cut."), now);
  Run(0.5);
  robot.connected = false;
  robot.speaking.reset();
  RobotCommand next = Act(2, "Two.");
  next.valid_for_us = 20 * kSecond;
  conductor->Offer(next, now);
  conductor->Offer(Act(3, "Three."), now);
  Run(5);
  EXPECT_EQ(Last(1), ActState::kFailed);
  EXPECT_EQ(Last(3), ActState::kExpired);
  robot.connected = true;
  conductor->Offer(Act(1, "One sentence that is long enough to be cut."), now);  // a late repeat
  Run(5);
  EXPECT_EQ(Last(2), ActState::kDone);
  EXPECT_EQ(robot.said.size(), 2u);
}

TEST_F(ConductorTest, SilentGuidanceMakesItRestAndTheNextActWakesIt) {
  conductor->Heartbeat(now);
  Run(9);
  EXPECT_THAT(robot.calls, Not(Contains("rest")));
  Run(3);
  EXPECT_THAT(robot.calls, Contains("rest"));
  conductor->Heartbeat(now);
  conductor->Offer(Act(1, "Hello again."), now);
  Run(3);
  EXPECT_THAT(robot.calls, Contains("wake"));
  EXPECT_EQ(Last(1), ActState::kDone);
}

TEST_F(ConductorTest, RestIsDoneWhenTheArmsAreDown) {
  RobotCommand act = Act(1, "Here.");
  act.point_target = Vector3(0.1, 0.05, 0.02);
  conductor->Offer(act, now);
  Run(1);
  RobotCommand rest = Act(2, "");
  rest.kind = ActKind::kRest;
  conductor->Offer(rest, now);
  Run(6);
  EXPECT_EQ(Last(2), ActState::kDone);
  EXPECT_EQ(robot.calls.back(), "rest");
  EXPECT_TRUE(conductor->body().arms_down());
}

TEST_F(ConductorTest, RetiringWithdrawsAndRests) {
  conductor->Offer(Act(1, "Good bye, everybody, see you tomorrow."), now);
  Run(0.5);
  conductor->Retire(now);
  Run(3);
  EXPECT_TRUE(conductor->at_rest());
  EXPECT_EQ(Last(1), ActState::kInterrupted);
}

TEST_F(ConductorTest, TouchesOfTheHeadAreCounted) {
  robot.pending = {{BackEndEvent::Kind::kHelpTouched, 0, ""}, {BackEndEvent::Kind::kHelpTouched, 0, ""}};
  Run(0.1);
  EXPECT_EQ(conductor->help_requests(), 2);
}

TEST_F(ConductorTest, FailedSpeechTellsWhy) {
  conductor->Offer(Act(1, "Bonjour."), now);
  Run(0.05);
  robot.pending = {{BackEndEvent::Kind::kSpeechFailed, 1, "no voice for the language 'xx'"}};
  Run(0.1);
  EXPECT_EQ(Last(1), ActState::kFailed);
  EXPECT_THAT(Reason(1), HasSubstr("no voice"));
}

}  // namespace
}  // namespace coach
