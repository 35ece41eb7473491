// Several tasks in a lesson.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

#include "classroom.h"

namespace coach {
namespace {

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

}  // namespace
}  // namespace coach
