#include "services/robot_bridge/nao_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "nao_lesson.h"

namespace coach {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

size_t IndexOf(const std::vector<std::string>& calls, const std::string& call) {
  return static_cast<size_t>(std::find(calls.begin(), calls.end(), call) - calls.begin());
}

TEST(NaoRobotTest, StartsInOrderAndStandsUpNever) {
  const FakeQiServer server({"--posture", "Crouch"});
  Lesson lesson(server);
  ASSERT_TRUE(lesson.WaitReady()) << lesson.robot.State().detail;
  const std::vector<std::string> calls = server.Calls();
  const char* order[] = {"ALSystem.systemVersion",
                         "ALMotion.getRobotConfig",
                         "ALMotion.getLimits",
                         "ALTextToSpeech.getAvailableLanguages",
                         "ALBattery.getBatteryCharge",
                         "ALAutonomousLife.setState",
                         "ALAutonomousLife.setAutonomousAbilityEnabled",
                         "ALMotion.setBreathEnabled",
                         "ALMotion.setIdlePostureEnabled",
                         "ALMotion.setCollisionProtectionEnabled",
                         "ALAnimatedSpeech.setBodyLanguageModeFromStr",
                         "ALRobotPosture.goToPosture",
                         "ALMotion.setStiffnesses",
                         "ALTextToSpeech.setVolume"};
  for (size_t i = 1; i < std::size(order); ++i) {
    EXPECT_LT(IndexOf(calls, order[i - 1]), IndexOf(calls, order[i])) << order[i];
    EXPECT_THAT(calls, Contains(order[i]));
  }
  EXPECT_THAT(calls, Not(Contains("ALMotion.wakeUp")));
  EXPECT_NEAR(lesson.robot.State().battery, 0.83, 1e-9);
  EXPECT_THAT(server.Violations(), IsEmpty());
}

TEST(NaoRobotTest, RobotThatWillNotSitSpeaksButDoesNotMove) {
  const FakeQiServer server({"--posture", "Stand", "--will-not-sit"});
  Lesson lesson(server);
  ASSERT_TRUE(lesson.WaitReady());
  EXPECT_THAT(lesson.robot.State().detail, HasSubstr("does not sit"));
  lesson.Act(1, "Here.", true);
  EXPECT_TRUE(lesson.Wait(8, [&] { return lesson.Ended(1); }));
  EXPECT_EQ(server.Count("ALMotion.setStiffnesses"), 0);
  EXPECT_EQ(server.Count("ALMotion.angleInterpolation"), 0);
  EXPECT_EQ(server.Count("ALTextToSpeech.say"), 1);
}

TEST(NaoRobotTest, SaysPointsLooksAndTakesTheArmDown) {
  const FakeQiServer server;
  Lesson lesson(server);
  ASSERT_TRUE(lesson.WaitReady());
  lesson.Act(1, "Put the blue brick here.", true);
  ASSERT_TRUE(lesson.Wait(10, [&] { return lesson.Ended(1); }));
  EXPECT_EQ(lesson.Last(1), ActState::kDone) << lesson.Reason(1);
  lesson.Wait(4, [&] { return lesson.conductor->body().arms_down(); });
  EXPECT_EQ(server.Count("ALTextToSpeech.say"), 1);
  EXPECT_EQ(server.LastArguments("ALLeds.fadeRGB")[1], 0x2d73e6);
  EXPECT_GE(server.Count("ALMotion.angleInterpolation"), 3);  // head, arm up, arm down
  EXPECT_THAT(server.Violations(), IsEmpty());                // limits and times are checked there
}

TEST(NaoRobotTest, StopReachesTheRobotWithinATenthOfASecond) {
  const FakeQiServer server;
  Lesson lesson(server);
  ASSERT_TRUE(lesson.WaitReady());
  for (int64_t id = 1; id <= 3; ++id) {
    lesson.Act(id, "A long sentence that the operator will certainly want to cut off somewhere.", true);
    lesson.Wait(0.6, [] { return false; });
    const int64_t begun = SteadyNow();
    const int before = server.Count("ALTextToSpeech.stopAll");
    const int frozen = server.Count("ALMotion.killTasksUsingResources");
    lesson.conductor->Stop(begun);
    EXPECT_TRUE(lesson.Wait(1, [&] {
      return server.Count("ALTextToSpeech.stopAll") > before &&
             server.Count("ALMotion.killTasksUsingResources") > frozen;
    }));
    EXPECT_LT(SteadyNow() - begun, 100000);
  }
  EXPECT_EQ(server.Count("ALMotion.rest"), 0);
  EXPECT_EQ(server.Count("ALMotion.setStiffnesses"), 1);
}

TEST(NaoRobotTest, LanguageThatTheRobotLacksIsStreamed) {
  if (InstalledVoices().empty()) GTEST_SKIP() << "espeak-ng is not installed";
  const FakeQiServer server;
  Lesson lesson(server);
  ASSERT_TRUE(lesson.WaitReady());
  lesson.Act(1, "Μπράβο, τα κατάφερες!", false, "el");
  ASSERT_TRUE(lesson.Wait(10, [&] { return lesson.Ended(1); }));
  EXPECT_EQ(lesson.Last(1), ActState::kDone) << lesson.Reason(1);
  EXPECT_EQ(server.Count("ALTextToSpeech.say"), 0);
  EXPECT_GE(server.Count("ALAudioDevice.sendRemoteBufferToOutput"), 1);
  for (const auto& event : server.Events()) {
    if (event.value("call", "") != "ALAudioDevice.sendRemoteBufferToOutput") continue;
    EXPECT_LE(event["arguments"][0], 16384);
    EXPECT_EQ(event["arguments"][1]["raw"], 4 * event["arguments"][0].get<int>());
  }
  lesson.Act(2, "?", false, "xx");
  ASSERT_TRUE(lesson.Wait(5, [&] { return lesson.Ended(2); }));
  EXPECT_EQ(lesson.Last(2), ActState::kFailed);
  EXPECT_THAT(lesson.Reason(2), HasSubstr("'xx'"));
}

TEST(NaoRobotTest, TouchOfTheHeadAsksForHelp) {
  FakeQiServer server;
  Lesson lesson(server);
  ASSERT_TRUE(lesson.WaitReady());
  lesson.Wait(1, [&] { return server.Events().back().contains("registered"); });
  server.Order("touch 1");
  server.Order("touch 0");
  EXPECT_TRUE(lesson.Wait(3, [&] { return lesson.conductor->help_requests() == 1; }));
}

TEST(NaoRobotTest, MissingServicesDoNotKeepItFromSpeaking) {
  const FakeQiServer server({"--without", "ALAutonomousLife", "ALLeds", "ALBattery", "ALAnimatedSpeech", "ALMemory"});
  Lesson lesson(server);
  ASSERT_TRUE(lesson.WaitReady());
  lesson.Act(1, "Hello.");
  ASSERT_TRUE(lesson.Wait(5, [&] { return lesson.Ended(1); }));
  EXPECT_EQ(lesson.Last(1), ActState::kDone);
  EXPECT_EQ(lesson.robot.State().battery, -1);
}

TEST(NaoRobotTest, RestartedRobotResumesAndSaysNothingTwice) {
  auto server = std::make_unique<FakeQiServer>();
  const std::string port = std::to_string(server->port());
  Lesson lesson(*server);
  ASSERT_TRUE(lesson.WaitReady());
  lesson.Act(1, "The first sentence, which is cut in the middle of it all.");
  lesson.Wait(0.4, [] { return false; });
  server->Kill();
  lesson.Act(2, "The second.");
  lesson.Wait(0.5, [] { return false; });
  EXPECT_FALSE(lesson.robot.State().connected);
  EXPECT_EQ(lesson.Last(1), ActState::kFailed);
  server = std::make_unique<FakeQiServer>(std::vector<std::string>{"--port", port});
  ASSERT_TRUE(lesson.WaitReady()) << lesson.robot.State().detail;
  lesson.Act(1, "The first sentence, which is cut in the middle of it all.");
  EXPECT_TRUE(lesson.Wait(8, [&] { return lesson.Ended(2); }));
  EXPECT_EQ(lesson.Last(2), ActState::kDone);
  EXPECT_EQ(server->Count("ALTextToSpeech.say"), 1);
  EXPECT_THAT(server->Violations(), IsEmpty());
}

TEST(NaoRobotTest, RestsAtTheEnd) {
  const FakeQiServer server;
  Lesson lesson(server);
  ASSERT_TRUE(lesson.WaitReady());
  lesson.conductor->Retire(SteadyNow());
  EXPECT_TRUE(lesson.Wait(3, [&] { return lesson.conductor->at_rest() && server.Count("ALMotion.rest") == 1; }));
}

}  // namespace
}  // namespace coach
