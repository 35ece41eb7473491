#include "tools/report/log_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "temporary_folder.h"
#include "written_lesson.h"

namespace coach {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class LogSessionTest : public testing::Test {
 protected:
  std::filesystem::path Played() {
    const auto file = folder_.path() / "lesson.lcm";
    WrittenLesson(file).Play();
    return file;
  }
  const TemporaryFolder folder_;
};

TEST_F(LogSessionTest, EverythingOfALessonIsThere) {
  const Session s = ReadLogSession({Played()});
  EXPECT_THAT(s.problems, IsEmpty());
  EXPECT_EQ(s.station, "CLASS");
  EXPECT_EQ(s.begin, WrittenLesson::At(0));
  EXPECT_EQ(s.frames.size(), 120u);
  EXPECT_FLOAT_EQ(s.frames[5].latency_ms, 20);
  EXPECT_EQ(s.tasks.size(), 1u);
  EXPECT_EQ(s.acts.size(), 5u);
  EXPECT_EQ(s.configurations.size(), 2u);
  EXPECT_EQ(s.states.size(), 30u);
}

TEST_F(LogSessionTest, WhatGoesByTheClockIsCarriedOverToTheDatasTime) {
  const Session s = ReadLogSession({Played()});
  const RobotAct& step = s.acts[1];
  EXPECT_NEAR(static_cast<double>(step.sent - s.begin) / 1e6, 7.5, 0.01);
  EXPECT_NEAR(static_cast<double>(step.started - s.begin) / 1e6, 7.7, 0.51);
  EXPECT_EQ(step.state, ActState::kDone);
}

TEST_F(LogSessionTest, AReplacedNoteCountsOnce) {
  const Session s = ReadLogSession({Played()});
  int corner_4 = 0;
  for (const Annotation& a : s.annotations) {
    if (a.kind == "connect" && a.subject == "corner_4") corner_4 += a.utime == WrittenLesson::At(51.4) ? 1 : 100;
  }
  EXPECT_EQ(corner_4, 1);
}

TEST_F(LogSessionTest, AnEventThatWasLostIsTakenFromTheState) {
  const auto file = folder_.path() / "lossy.lcm";
  {
    WrittenLesson lesson(file);
    lesson.Frame(1);
    AssemblyState state;
    state.utime = WrittenLesson::At(2);
    GuidanceEvent e;
    e.id = 1;
    e.utime = e.since = WrittenLesson::At(1.5);
    e.kind = "connect";
    e.subject = "corner_1";
    state.events = {e};
    lesson.Write(2, ToMessage(state));
    lesson.Write(2.1, ToMessage(e));
    lesson.Write(2.5, ToMessage(state));
  }
  EXPECT_EQ(ReadLogSession({file}).events.size(), 1u);
}

TEST_F(LogSessionTest, ACutOffLogIsUsedAsFarAsItGoes) {
  const auto file = Played();
  const auto size = std::filesystem::file_size(file);
  for (const double share : {0.999, 0.5, 0.1, 0.001}) {
    std::filesystem::resize_file(file, static_cast<uintmax_t>(static_cast<double>(size) * share));
    const Session s = ReadLogSession({file});
    EXPECT_THAT(s.problems, Contains(testing::AnyOf(HasSubstr("cut off"), HasSubstr("empty")))) << share;
    EXPECT_LE(s.frames.size(), 120u);
  }
}

TEST_F(LogSessionTest, AnEmptyLogSaysSo) {
  const auto file = folder_.path() / "empty.lcm";
  { LogWriter writer(file); }
  const Session s = ReadLogSession({file});
  EXPECT_THAT(s.problems, ElementsAre(HasSubstr("the recording is empty"), HasSubstr("no message of Coach")));
  EXPECT_THROW(ReadLogSession({folder_.path() / "none.lcm"}), std::runtime_error);
}

TEST_F(LogSessionTest, OtherVersionsDamageAndOtherStationsAreLeftOutAndSaid) {
  const auto file = folder_.path() / "mixed.lcm";
  {
    WrittenLesson lesson(file);
    lesson.Frame(0);
    lesson.Frame(1);
    lesson.WriteBytes(1.5, "PART_POSES", {1, 2, 3, 4, 5, 6, 7, 8, 9});
    lesson.WriteBytes(1.6, "ANNOTATION", {1});
    task_t task{};
    std::vector<uint8_t> bytes(static_cast<size_t>(task.getEncodedSize()));
    task.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    bytes.push_back(0);
    lesson.WriteBytes(1.7, "TASK", bytes);
    lesson.WriteBytes(1.8, "SOMETHING_ELSE", {1});
  }
  const Session s = ReadLogSession({file});
  EXPECT_EQ(s.frames.size(), 2u);
  EXPECT_THAT(s.problems, ElementsAre("ANNOTATION: 1 messages of another version of Coach, left out",
                                      "PART_POSES: 1 messages of another version of Coach, left out",
                                      "TASK: 1 damaged messages, left out"));

  const auto other = folder_.path() / "other.lcm";
  { WrittenLesson(other, "NEXT_DOOR").Frame(2); }
  const Session both = ReadLogSession({file, other});
  EXPECT_EQ(both.frames.size(), 2u);
  EXPECT_THAT(both.problems, Contains("station NEXT_DOOR: 1 messages, left out"));
  EXPECT_EQ(ReadLogSession({file, other}, "NEXT_DOOR").frames.size(), 1u);
}

}  // namespace
}  // namespace coach
