#include "tools/operator/lesson.h"

#include <gtest/gtest.h>

#include <thread>

#include "common/assembly/task_file.h"
#include "tools/operator/page_json.h"

namespace coach {
namespace {

const CameraModel kCamera{640, 480, 500, 500, 320, 240, {}};

PartPoses PosesAt(int64_t utime, size_t parts) {
  PartPoses poses;
  poses.utime = utime;
  poses.parts.resize(parts);
  for (size_t k = 0; k < parts; ++k) {
    poses.parts[k].X_TP = MakePose(Matrix3::Identity(), Vector3(0.2 * static_cast<double>(k) - 0.3, 0, 0.8));
    poses.parts[k].status = PartStatus::kTracked;
  }
  return poses;
}

GuidanceEvent Event(int64_t id, const std::string& kind, const std::string& subject) {
  GuidanceEvent event;
  event.id = id;
  event.utime = event.since = 10 * id;
  event.kind = kind;
  event.subject = subject;
  return event;
}

std::shared_ptr<const TaskView> Rectangle() {
  return LoadTaskView(std::filesystem::path(COACH_SOURCE_DIR) / "deploy/tasks/rectangle_long_medium.yaml", 1);
}

TEST(Lesson, APictureIsShownWithThePosesOfItsOwnMoment) {
  Lesson lesson({});
  lesson.OnTask(Rectangle());
  lesson.OnPicture({1'000'000, kCamera, {1}});
  EXPECT_EQ(lesson.view(), nullptr) << "its poses have not come";
  lesson.OnPicture({1'033'000, kCamera, {2}});
  lesson.OnPoses(PosesAt(1'033'000, 4));
  const auto view = lesson.view();
  ASSERT_NE(view, nullptr);
  EXPECT_EQ(view->picture->jpeg, std::vector<uint8_t>{2});
  ASSERT_EQ(view->outlines.size(), 4u);
  EXPECT_FALSE(view->outlines[1].empty());
}

TEST(Lesson, WithoutTrackerThePictureIsShownAlone) {
  Lesson lesson({});
  for (int k = 0; k < 20; ++k) lesson.OnPicture({k * 33'000, kCamera, {static_cast<uint8_t>(k)}});
  ASSERT_NE(lesson.view(), nullptr);
  EXPECT_TRUE(lesson.view()->poses.parts.empty());
  EXPECT_NE(lesson.view()->picture, nullptr);
}

TEST(Lesson, WithoutCameraThePosesAreShownAlone) {
  Lesson lesson({});
  lesson.OnTask(Rectangle());
  lesson.OnPoses(PosesAt(5, 4));
  ASSERT_NE(lesson.view(), nullptr);
  EXPECT_EQ(lesson.view()->picture, nullptr);
  EXPECT_EQ(lesson.view()->poses.parts.size(), 4u);
}

TEST(Lesson, NoMoreViewsThanAskedForAndATimeThatRestartsIsFollowed) {
  Lesson lesson({.picture_rate = 10});
  for (int k = 0; k < 60; ++k) lesson.OnPoses(PosesAt(10'000'000 + k * 33'333, 1));
  EXPECT_GE(lesson.view()->number, 15);
  EXPECT_LE(lesson.view()->number, 22);
  const int64_t before = lesson.view()->number;
  lesson.OnPoses(PosesAt(0, 1));
  EXPECT_EQ(lesson.view()->number, before + 1) << "a recording begins anew";
}

TEST(Lesson, PosesOfAnotherTaskAreNotDrawn) {
  Lesson lesson({});
  lesson.OnTask(Rectangle());
  lesson.OnPicture({7, kCamera, {1}});
  lesson.OnPoses(PosesAt(7, 9));
  EXPECT_TRUE(lesson.view()->outlines.empty());
}

TEST(Lesson, RepeatedEventsCountOnceAndANewSessionStartsEmpty) {
  Lesson lesson({});
  AssemblyState state;
  state.session = 1;
  state.events = {Event(1, "session", "start"), Event(2, "connect", "c1")};
  lesson.OnState(state, 0);
  lesson.OnState(state, 0);
  lesson.OnEvent(Event(2, "connect", "c1"));
  lesson.OnEvent(Event(3, "connect", "c2"));
  EXPECT_EQ(lesson.Read(0).events.size(), 3u);
  ASSERT_EQ(lesson.Read(2).events.size(), 1u);
  EXPECT_EQ(lesson.Read(2).events[0].subject, "c2");
  state.session = 2;
  state.events.clear();
  lesson.OnState(state, 0);
  EXPECT_TRUE(lesson.Read(0).events.empty());
}

TEST(Lesson, AnActIsFollowedFromTheQueueToItsEnd) {
  Lesson lesson({});
  RobotCommand command;
  command.id = 5;
  command.text = "Well done!";
  for (int repeat = 0; repeat < 3; ++repeat) lesson.OnCommand(command, 0);
  ASSERT_EQ(lesson.Read(0).acts.size(), 1u);
  RobotStatus status;
  status.command_id = 5;
  for (const ActState state : {ActState::kQueued, ActState::kStarted, ActState::kDone}) {
    status.state = state;
    lesson.OnStatus(status, 0);
    EXPECT_EQ(lesson.Read(0).acts[0].state, state);
  }
  status.state = ActState::kStarted;
  lesson.OnStatus(status, 0);
  EXPECT_EQ(lesson.Read(0).acts[0].state, ActState::kDone) << "what is over stays over";
}

TEST(Lesson, MemoryIsBounded) {
  Lesson lesson({.max_events = 50, .max_acts = 10});
  for (int k = 1; k <= 1000; ++k) {
    lesson.OnEvent(Event(k, "say", "x"));
    RobotCommand command;
    command.id = k;
    lesson.OnCommand(command, 0);
  }
  EXPECT_EQ(lesson.Read(0).events.size(), 50u);
  EXPECT_EQ(lesson.Read(0).events.back().id, 1000);
  EXPECT_EQ(lesson.Read(0).acts.size(), 10u);
}

TEST(Lesson, WaitingEndsWithNewsAndWithTheProgram) {
  Lesson lesson({});
  const int64_t revision = lesson.Read(0).revision;
  EXPECT_FALSE(lesson.WaitForChange(revision, 5));
  std::thread writer([&] { lesson.Touch(); });
  EXPECT_TRUE(lesson.WaitForChange(revision, 10'000));
  writer.join();
  std::thread closer([&] { lesson.Close(); });
  EXPECT_EQ(lesson.WaitForView(0, 60'000), nullptr);
  closer.join();
}

TEST(LoadTaskView, AFileThatCantBeUsedIsAProblemNotAnEnd) {
  EXPECT_NE(LoadTaskView("/nonexistent.yaml", 3)->problem, "");
  EXPECT_EQ(LoadTaskView("/nonexistent.yaml", 3)->task, nullptr);
  EXPECT_EQ(Rectangle()->problem, "");
  EXPECT_EQ(Rectangle()->choice, "rectangle_long_medium");
}

}  // namespace
}  // namespace coach
