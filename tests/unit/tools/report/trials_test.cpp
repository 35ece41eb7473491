#include "tools/report/trials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/report/table1.h"

namespace coach {
namespace {

using testing::ElementsAre;

constexpr int64_t kSecond = 1'000'000;

class TrialsTest : public testing::Test {
 protected:
  TrialsTest() {
    TaskNames task;
    task.name = "rectangle";
    task.parts = {"long_1", "long_2", "medium_1", "medium_2"};
    task.part_types = {0, 0, 1, 1};
    task.connections = {"corner_1", "corner_2"};
    session_.tasks = {task};
  }
  void Event(double t, const std::string& kind, const std::string& subject, int a = -1, int b = -1,
             const std::string& reason = "") {
    GuidanceEvent e;
    e.id = ++id_;
    e.utime = e.since = At(t);
    e.kind = kind;
    e.subject = subject;
    e.part_a = a;
    e.part_b = b;
    e.reason = reason;
    session_.events.push_back(e);
    session_.end = std::max(session_.end, e.utime);
  }
  void Truth(double t, const std::string& kind, const std::string& subject) {
    session_.annotations.push_back({At(t), ++id_, "AK", kind, subject, "", 0});
  }
  static int64_t At(double t) { return static_cast<int64_t>(t * 1e6); }
  std::vector<std::string> Spans() const {
    std::vector<std::string> out;
    for (const TrialSpan& t : FindTrials(session_))
      out.push_back(std::to_string(t.begin / kSecond) + "-" + std::to_string(t.end / kSecond) +
                    (t.completed ? "!" : "") + (t.started ? "" : "?"));
    return out;
  }

  Session session_;
  int64_t id_ = 0;
};

TEST_F(TrialsTest, ButtonPhaseAndFirstSentenceAreOneBeginning) {
  Event(1, "operator", "start");
  Event(1, "phase", "introduction");
  Event(2, "say", "introduction");
  Event(5, "phase", "announce");
  Event(30, "phase", "complete");
  Event(40, "disconnect", "corner_1");
  EXPECT_THAT(Spans(), ElementsAre("1-30!"));
}

TEST_F(TrialsTest, AnotherTaskOrAnotherStartEndsATrial) {
  Event(1, "operator", "start");
  Event(3, "phase", "announce");
  Event(10, "operator", "choose_task", -1, -1, "square");
  Event(10, "phase", "introduction");
  Event(12, "phase", "announce");
  Event(20, "operator", "start", -1, -1, "refused: the lesson is running");
  Event(25, "phase", "complete");
  Event(30, "operator", "choose_task", -1, -1, "rectangle");
  Event(31, "operator", "start");
  Event(50, "phase", "announce");
  EXPECT_THAT(Spans(), ElementsAre("1-10", "10-25!", "31-50"));
  EXPECT_EQ(FindTrials(session_)[1].task, "square");
  EXPECT_EQ(FindTrials(session_)[2].task, "rectangle");
}

TEST_F(TrialsTest, TheNextTaskOfALessonIsATrialOfItsOwn) {
  Event(1, "operator", "start");
  Event(3, "phase", "announce");
  Event(25, "phase", "complete");
  Event(50, "session", "next_task", -1, -1, "square");
  Event(50, "phase", "introduction");
  Event(52, "phase", "announce");
  Event(70, "phase", "complete");
  EXPECT_THAT(Spans(), ElementsAre("1-25!", "50-70!"));
  EXPECT_EQ(FindTrials(session_)[1].task, "square");
}

TEST_F(TrialsTest, ALogThatBeginsInTheMiddleOrHasNoLesson) {
  Event(7, "connect", "corner_1");
  EXPECT_THAT(Spans(), ElementsAre("0-7?"));
  Event(8, "phase", "correct");
  Event(9, "phase", "complete");
  EXPECT_THAT(Spans(), ElementsAre("8-9!"));
  session_.events.clear();
  session_.end = 0;
  EXPECT_THAT(Spans(), ElementsAre());
}

TEST_F(TrialsTest, EqualPartsMayStandForEachOther) {
  Event(0, "phase", "announce");
  Event(10, "connect", "corner_2", 1, 3);
  Event(20, "connect", "corner_1", 0, 2);
  Event(60, "phase", "away");
  Truth(9, "connect", "corner_1");
  Truth(19, "connect", "corner_2");
  const auto trials = Trials(session_);
  ASSERT_EQ(trials.size(), 1u);
  ASSERT_EQ(trials[0].truth.size(), 2u);
  EXPECT_EQ(trials[0].truth[0].detected, 0u);
  EXPECT_EQ(trials[0].truth[1].detected, 1u);
  EXPECT_DOUBLE_EQ(trials[0].truth[1].dating, 1);
}

TEST_F(TrialsTest, OneToOneSmallestDifferenceFirstWithinTwentySeconds) {
  Event(0, "phase", "announce");
  Event(10, "connect", "corner_1", 0, 2);
  Event(12, "connect", "corner_1", 0, 2);
  Event(55, "connect", "corner_1", 0, 2);
  Event(70, "phase", "away");
  Truth(12.5, "connect", "corner_1");
  Truth(34, "connect", "corner_1");
  Truth(40, "wrong", "corner_1");
  const auto trial = Trials(session_).at(0);
  EXPECT_EQ(trial.truth[0].detected, 1u);
  EXPECT_FALSE(trial.truth[1].detected) << "21 s away";
  EXPECT_FALSE(trial.truth[2].detected) << "another kind";
  const TrialFigures f = FiguresOf(trial, session_);
  EXPECT_EQ(f.connections, 2);
  EXPECT_EQ(f.wrong, 1);
  EXPECT_EQ(f.false_alarms, 2);
  EXPECT_THAT(f.delays_connect, ElementsAre(-0.5));
}

TEST_F(TrialsTest, AnUnknownMistakeIsAnyMistake) {
  Event(0, "phase", "announce");
  Event(10, "wrong", "medium_on_medium", 2, 3);
  Event(30, "phase", "away");
  Truth(9, "wrong", "unknown");
  EXPECT_TRUE(Trials(session_).at(0).truth[0].detected);
}

TEST_F(TrialsTest, ADelayBeginsWhenBothPartsCanBeSeen) {
  Event(0, "phase", "announce");
  Event(16, "connect", "corner_1", 0, 2);
  Event(30, "phase", "away");
  Truth(10, "connect", "corner_1");
  for (int t = 0; t < 30; ++t) {
    TrackedFrame frame;
    frame.utime = At(t);
    frame.parts.assign(4, {PartStatus::kTracked, 0.9F});
    if (t < 15) frame.parts[2] = {PartStatus::kOccluded, 0.1F};
    session_.frames.push_back(frame);
  }
  const auto trial = Trials(session_).at(0);
  EXPECT_DOUBLE_EQ(trial.truth[0].delay, 1);
  EXPECT_DOUBLE_EQ(trial.truth[0].dating, 6);
  EXPECT_NEAR(FiguresOf(trial, session_).tracked_share, 1 - 15.0 / 120, 1e-9);
}

TEST_F(TrialsTest, TakenApartAndPutTogetherAgainIsNoNewTrial) {
  Event(0, "phase", "announce");
  Event(10, "phase", "complete");
  Event(14, "disconnect", "corner_1", 0, 2);
  Event(14, "phase", "wait");
  Event(18, "connect", "corner_1", 0, 2);
  Event(18, "phase", "complete");
  EXPECT_THAT(Spans(), ElementsAre("0-10!"));
  EXPECT_TRUE(Trials(session_).at(0).detected.empty());
}

TEST_F(TrialsTest, WhatWasCalledCompleteTooEarlyIsCountedToItsTrueEnd) {
  Event(0, "phase", "announce");
  Event(10, "connect", "corner_1", 0, 2);
  Event(10, "phase", "complete");
  Event(29, "connect", "corner_2", 1, 3);
  Event(40, "connect", "corner_2", 1, 3);
  Truth(9, "connect", "corner_1");
  Truth(28, "connect", "corner_2");
  Truth(36, "disconnect", "corner_2");
  const auto trial = Trials(session_).at(0);
  EXPECT_EQ(trial.truth.size(), 2u);
  EXPECT_EQ(trial.detected.size(), 2u);
  EXPECT_EQ(trial.seconds(), 10);
}

TEST_F(TrialsTest, LastWordsBelongToTheTrialWhatIsTakenApartDoesNot) {
  Event(0, "phase", "announce");
  Event(10, "phase", "complete");
  Event(11, "say", "complete");
  Event(12, "disconnect", "corner_1", 0, 2);
  Event(30, "say", "operator");
  const auto trial = Trials(session_).at(0);
  EXPECT_EQ(trial.events.size(), 3u);
  EXPECT_TRUE(trial.detected.empty());
}

TEST_F(TrialsTest, TableOneCountsAndComparesWithThePaper) {
  std::vector<Trial> trials(3);
  std::vector<TrialFigures> figures(3);
  for (size_t i = 0; i < 3; ++i) {
    trials[i].span.task = i < 2 ? "rectangle_long_short" : "tower";
    figures[i].annotated = true;
    figures[i].completed = i != 1;
    figures[i].seconds = 60;
    figures[i].connections = 4;
    figures[i].wrong = 1;
    figures[i].delays_connect = {0.5, 2, static_cast<double>(6 + i)};
    figures[i].delays_wrong = {3};
    figures[i].reported = 5;
    figures[i].false_alarms = 1;
  }
  const auto groups = Table1(trials, figures);
  ASSERT_EQ(groups.size(), 3u);
  EXPECT_EQ(groups[0].title, "All trials");
  EXPECT_EQ(groups[1].title, "Rectangles");
  EXPECT_EQ(groups[2].title, "tower");
  const auto measure = [&](size_t group, const std::string& name) {
    for (const Measure& m : groups[group].measures) {
      if (m.name == name) return m;
    }
    ADD_FAILURE() << name;
    return Measure();
  };
  const Measure within = measure(1, "All announced within 5 s");
  EXPECT_EQ(within.k, 6);
  EXPECT_EQ(within.n, 10);
  EXPECT_DOUBLE_EQ(within.value, 60);
  EXPECT_EQ(within.paper, 50.0);
  EXPECT_EQ(within.method, "bootstrap");
  EXPECT_DOUBLE_EQ(measure(1, "Announced after, median").value, 2.5);
  EXPECT_DOUBLE_EQ(measure(0, "Correct ones within 1 s").value, 25);
  EXPECT_DOUBLE_EQ(measure(0, "Right among what was announced (precision)").value, 80);
  EXPECT_DOUBLE_EQ(measure(1, "Completed").value, 50);
  EXPECT_EQ(measure(2, "Completed").method, "Wilson");
  EXPECT_FALSE(measure(2, "Mistakes a trial").paper);
}

TEST_F(TrialsTest, WithoutAnnotationNothingIsFalseOrLate) {
  Event(0, "phase", "announce");
  Event(10, "connect", "corner_1", 0, 2);
  Event(30, "phase", "complete");
  const auto trials = Trials(session_);
  const TrialFigures f = FiguresOf(trials[0], session_);
  EXPECT_EQ(f.false_alarms, 0);
  EXPECT_EQ(f.connections, 1);
  for (const Measure& m : Table1(trials, {f}).at(0).measures) {
    if (m.name.find("within") != std::string::npos || m.name == "False alarms") {
      EXPECT_TRUE(std::isnan(m.value)) << m.name;
    }
  }
}

}  // namespace
}  // namespace coach
