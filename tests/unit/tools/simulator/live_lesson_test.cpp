#include "tools/simulator/live_lesson.h"

#include <gmock/gmock.h>

#include "common/assembly/task_file.h"

namespace coach {
namespace {

using Temper = LiveLessonOptions::Temper;

LiveLesson Start(Temper temper) {
  ScenarioOptions options;
  options.name = "ready";
  options.seed = 3;
  LiveLessonOptions live;
  live.temper = temper;
  return LiveLesson(MakeScenario(LoadTask(COACH_SOURCE_DIR "/deploy/tasks/rectangle_long_medium.yaml"), options), live);
}

int Count(const LiveLesson& lesson, const std::string& kind) {
  const auto& events = lesson.performance().events;
  return static_cast<int>(
      std::count_if(events.begin(), events.end(), [&](const TrueEvent& e) { return e.kind == kind; }));
}

/// A robot that knows the truth: asks for the task's steps in turn, and objects to mistakes, each 2 s after the event.
double Teach(LiveLesson* lesson, bool speaks) {
  const Task& task = lesson->scenario().stage.task;
  for (double t = 0; t < 300; t += 0.1) {
    if (speaks && std::fmod(t, 2) < 0.1) {
      const int made = Count(*lesson, "connect");
      if (Count(*lesson, "wrong_connect") > Count(*lesson, "disconnect")) {
        lesson->SayWrong();
      } else {
        lesson->Ask(task.steps[static_cast<size_t>(std::min(made, static_cast<int>(task.steps.size()) - 1))]);
      }
    }
    lesson->Advance(t);
    if (lesson->complete()) return t;
  }
  return 300;
}

TEST(LiveLessonTest, AChildThatListensFinishesWithoutAMistake) {
  LiveLesson lesson = Start(Temper::kListens);
  EXPECT_LT(Teach(&lesson, true), 60);
  EXPECT_EQ(Count(lesson, "connect"), 4);
  EXPECT_EQ(Count(lesson, "wrong_connect"), 0);
}

TEST(LiveLessonTest, AChildThatListensWaitsForAWordAndThenHelpsItself) {
  LiveLesson lesson = Start(Temper::kListens);
  for (double t = 0; t < 29; t += 0.1) lesson.Advance(t);
  EXPECT_TRUE(lesson.performance().events.empty());
  const double end = Teach(&lesson, false);
  EXPECT_GT(end, 50);
  EXPECT_LT(end, 300);
  EXPECT_GT(Count(lesson, "wrong_connect"), 0);
}

TEST(LiveLessonTest, WordsAreUnderstoodByTheirKey) {
  LiveLesson lesson = Start(Temper::kListens);
  lesson.Advance(1);
  lesson.Hear("hello", 0);
  for (double t = 1; t < 10; t += 0.1) lesson.Advance(t);
  EXPECT_TRUE(lesson.performance().events.empty());
  lesson.Hear("step", 0);
  for (double t = 10; t < 20; t += 0.1) lesson.Advance(t);
  EXPECT_EQ(Count(lesson, "connect"), 1);
  EXPECT_THROW(TemperByName("obeys"), std::invalid_argument);
}

TEST(LiveLessonTest, AChildThatErrsIsCorrected) {
  LiveLesson lesson = Start(Temper::kErrs);
  EXPECT_LT(Teach(&lesson, true), 120);
  EXPECT_GT(Count(lesson, "wrong_connect"), 0);
  EXPECT_EQ(Count(lesson, "wrong_connect"), Count(lesson, "disconnect"));
}

TEST(LiveLessonTest, AChildThatErrsComesBackToWhatItWasAsked) {
  LiveLesson lesson = Start(Temper::kErrs);
  const std::vector<int>& steps = lesson.scenario().stage.task.steps;
  double t = 0;
  const auto pass = [&](double seconds) {
    for (const double end = t + seconds; t < end; t += 0.1) lesson.Advance(t);
  };
  lesson.Ask(steps[0]);
  pass(20);
  ASSERT_EQ(Count(lesson, "connect"), 1);
  lesson.Ask(steps[1]);
  pass(10);
  ASSERT_EQ(Count(lesson, "wrong_connect"), 1);
  lesson.SayWrong();
  pass(20);
  EXPECT_EQ(Count(lesson, "disconnect"), 1);
  EXPECT_EQ(Count(lesson, "connect"), 2);
}

TEST(LiveLessonTest, AChildThatNeverListensIsNotMovedByWords) {
  LiveLesson quiet = Start(Temper::kNeverListens), spoken_to = Start(Temper::kNeverListens);
  EXPECT_EQ(Teach(&quiet, false), Teach(&spoken_to, true));
}

TEST(LiveLessonTest, WhatHasBeenSeenDoesNotChange) {
  LiveLesson lesson = Start(Temper::kListens);
  std::vector<Pose> seen;
  for (double t = 0; t < 30; t += 0.1) {
    if (t > 1) lesson.Ask(0);
    lesson.Advance(t);
    seen.push_back(lesson.performance().things.At(2, t));
  }
  for (size_t i = 0; i < seen.size(); ++i) {
    EXPECT_TRUE(seen[i].isApprox(lesson.performance().things.At(2, 0.1 * static_cast<double>(i)), 1e-6)) << i;
  }
}

}  // namespace
}  // namespace coach
