// The course of a lesson: greeting, steps, praise, hints, parts out of sight.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "classroom.h"

namespace coach {
namespace {

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

TEST(Lesson, HelpIsGivenAtOnce) {
  Classroom room(3);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.Operator(OperatorKind::kHelp);
  room.Run(2);
  EXPECT_EQ(room.said.back().command.phrase_key, "idle_1");
  EXPECT_LT(room.now() - room.said.back().at, 2000001);
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
