// Every call that a lesson makes, hanging or failing: the next act is still said.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "nao_lesson.h"

namespace coach {
namespace {

/// Empty, or what went wrong.
std::string ProblemWith(const std::string& fault, const std::string& call) {
  FakeQiServer server;
  server.Order(fault + " " + call);
  NaoOptions options = OptionsFor(server);
  options.call_timeout_s = 0.2;
  Lesson lesson(options);
  if (!lesson.WaitReady()) return "never ready: " + lesson.robot.State().detail;
  lesson.Act(1, "Here.", true);
  if (!lesson.Wait(15, [&] { return lesson.Ended(1); })) return "the first act never ended";
  server.Order("ok " + call);
  lesson.Wait(0.1, [] { return false; });
  lesson.Act(2, "And here.");
  if (!lesson.Wait(15, [&] { return lesson.Ended(2); })) return "the second act never ended";
  if (lesson.Last(2) != ActState::kDone) return "the second act failed: " + lesson.Reason(2);
  return server.Violations().empty() ? "" : server.Violations().front();
}

TEST(NaoFaultsTest, OneCallThatHangsOrFailsIsSurvived) {
  const char* calls[] = {"ALSystem.systemVersion",      "ALMotion.getRobotConfig",
                         "ALMotion.getLimits",          "ALTextToSpeech.getAvailableLanguages",
                         "ALBattery.getBatteryCharge",  "ALAutonomousLife.setAutonomousAbilityEnabled",
                         "ALMotion.setBreathEnabled",   "ALMotion.setStiffnesses",
                         "ALRobotPosture.getPosture",   "ALMotion.getAngles",
                         "ALMotion.angleInterpolation", "ALLeds.fadeRGB",
                         "ALTextToSpeech.setLanguage",  "ALTextToSpeech.say",
                         "ALMemory.subscriber",         "ALAudioDevice.setOutputVolume"};
  std::vector<std::pair<std::string, std::string>> cases{{"fail", "ALAutonomousLife.setState"}};
  for (const char* call : calls) {
    cases.emplace_back("fail", call);
    cases.emplace_back("hang", call);
  }
  std::atomic<size_t> next = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 11; ++i) {
    threads.emplace_back([&] {
      for (size_t c = next++; c < cases.size(); c = next++) {
        EXPECT_EQ(ProblemWith(cases[c].first, cases[c].second), "") << cases[c].first << " " << cases[c].second;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace coach
