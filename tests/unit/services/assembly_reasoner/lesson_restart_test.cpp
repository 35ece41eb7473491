// A new process takes over from the state file, whatever the lesson was at.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "classroom.h"

namespace coach {
namespace {

/// 90 s with a mistake, its undoing and a finished rectangle; the process is killed after `kill_at` s (0: never).
Classroom PlayKilledAt(double kill_at) {
  Classroom room(30);
  room.Operator(OperatorKind::kStart);
  for (int tenth = 0; tenth < 900; tenth += 2) {
    if (tenth == 200) room.Join(0, 1, Rectangle().mistakes[0].X_AB);
    if (tenth == 400) room.Undo(0, 1);
    if (tenth == 500) room.JoinRight(0);
    if (tenth == 600) room.JoinRight(1);
    if (tenth == 700) room.Build();
    room.Run(0.2);
    if (tenth == static_cast<int>(10 * kill_at)) room.Restart();
  }
  return room;
}

TEST(LessonRestart, KilledAtAnyMomentTheLessonGoesOnAndNothingIsSaidTwice) {
  const Classroom whole = PlayKilledAt(0);
  ASSERT_EQ(whole.state().phase, Phase::kComplete);
  for (double kill_at = 0.2; kill_at < 89; kill_at += 1) {
    SCOPED_TRACE(kill_at);
    const Classroom killed = PlayKilledAt(kill_at);
    EXPECT_EQ(killed.state().phase, Phase::kComplete);
    EXPECT_EQ(killed.state().made, 4);
    EXPECT_EQ(killed.state().session, whole.state().session);
    for (const char* key : {"introduction", "step", "complete"}) EXPECT_EQ(killed.Count(key), whole.Count(key)) << key;
    EXPECT_EQ(killed.Count("introduction_again"), 0);
    for (const char* key : {"praise", "wrong"}) {
      EXPECT_LE(killed.Count(key), whole.Count(key)) << key;
      EXPECT_GE(killed.Count(key), whole.Count(key) - 1) << key;
    }
  }
}

TEST(LessonRestart, WhatTheOperatorSetHolds) {
  Classroom room(31);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.Operator(OperatorKind::kLanguage, "el");
  room.Operator(OperatorKind::kMarkDone, "corner_1");  // though the parts are seen apart
  room.JoinRight(1);
  room.Run(10);
  room.Operator(OperatorKind::kMarkUndone, "corner_2");  // though they are seen together
  room.Operator(OperatorKind::kSkip);
  room.Run(5);
  const int step = room.state().step;
  ASSERT_EQ(room.state().made, 1);
  room.Operator(OperatorKind::kPause);
  room.Run(5);
  const size_t said = room.said.size();
  room.Restart();
  room.Run(60);
  EXPECT_EQ(room.said.size(), said) << "a pause is quiet";
  EXPECT_EQ(room.state().phase, Phase::kPaused);
  room.Operator(OperatorKind::kResume);
  room.Run(15);
  EXPECT_EQ(room.state().made, 1);
  EXPECT_EQ(room.state().step, step);
  ASSERT_GT(room.said.size(), said);
  EXPECT_EQ(room.said.back().command.language, "el");
}

TEST(LessonRestart, AChosenTaskStaysChosen) {
  std::vector<Task> tasks(2, Rectangle());
  tasks[1].name = "second";
  Classroom room(32, {}, tasks);
  room.Run(1);
  room.Operator(OperatorKind::kStart);
  room.Run(10);
  room.Operator(OperatorKind::kChooseTask, "second");
  room.RunOn(15);
  room.Restart();
  room.Run(5);
  EXPECT_EQ(room.state().task, "second");
  EXPECT_EQ(room.Count("introduction"), 1);
  EXPECT_EQ(room.Count("introduction_again"), 1);
}

TEST(LessonRestart, TheHintLadderGoesOn) {
  Classroom room(33);
  room.Operator(OperatorKind::kStart);
  while (room.Count("idle_2") == 0 && room.now() < 200'000'000) room.Run(0.2);
  room.Restart();
  room.Run(120);
  EXPECT_THAT(room.Keys(), testing::ElementsAre("introduction", "step", "idle_1", "idle_2", "idle_3", "idle_4"));
}

TEST(LessonRestart, CorrectionsKeepTheirCountAndTheirDistance) {
  Classroom room(34);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.Join(0, 1, Rectangle().mistakes[0].X_AB);
  while (room.Count("wrong") < 2 && room.now() < 200'000'000) room.Run(0.2);
  room.Restart();
  room.Run(11);
  EXPECT_EQ(room.Count("wrong"), 2);
  room.Run(120);
  EXPECT_EQ(room.Count("wrong"), 3);
  EXPECT_EQ(room.Count("wrong_last"), 1);
}

TEST(LessonRestart, AfterTheEndNothingIsSaid) {
  Classroom room(35);
  room.Operator(OperatorKind::kStart);
  room.Run(20);
  room.Build();
  room.Run(20);
  ASSERT_EQ(room.Count("complete"), 1);
  const size_t said = room.said.size();
  room.Restart();
  room.Run(60);
  EXPECT_EQ(room.said.size(), said);
  EXPECT_EQ(room.state().phase, Phase::kComplete);
}

}  // namespace
}  // namespace coach
