#include "services/robot_bridge/virtual_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "services/robot_bridge/robot_options.h"

namespace coach {
namespace {

using nlohmann::json;
using testing::HasSubstr;

int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// An attached client that keeps every event.
class Listener {
 public:
  explicit Listener(int port) : client_("127.0.0.1", port) {
    client_.set_read_timeout(10);
    thread_ = std::thread([this] {
      std::string text;
      client_.Get("/events", [&](const char* data, size_t size) {
        text.append(data, size);
        for (size_t end = text.find("\n\n"); end != std::string::npos; end = text.find("\n\n")) {
          const std::string event = text.substr(0, end);
          text.erase(0, end + 2);
          const std::lock_guard lock(mutex_);
          if (event.starts_with("data: ")) events_.push_back(json::parse(event.substr(6)));
        }
        return true;
      });
    });
  }
  ~Listener() {
    client_.stop();
    thread_.join();
  }
  json Find(const std::string& type) {
    const std::lock_guard lock(mutex_);
    for (const json& event : events_) {
      if (event["type"] == type) return event;
    }
    return nullptr;
  }

 private:
  httplib::Client client_;
  std::thread thread_;
  std::mutex mutex_;
  std::vector<json> events_;
};

class VirtualRobotTest : public testing::Test {
 protected:
  static VirtualRobotOptions AnyPort() {
    VirtualRobotOptions options;
    options.port = 0;
    return options;
  }
  /// Polls the robot until the condition holds, five seconds at most.
  bool Until(const std::function<bool()>& condition) {
    for (const int64_t end = Now() + 5000000; Now() < end;) {
      for (const BackEndEvent& event : robot.Poll(Now())) events.push_back(event);
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  int Post(const std::string& body, const httplib::Headers& headers = {}) {
    httplib::Client client("127.0.0.1", robot.port());
    const auto result = client.Post("/report", headers, body, "application/json");
    return result ? result->status : 0;
  }

  VirtualRobot robot{AnyPort(), DefaultRobotPose()};
  std::vector<BackEndEvent> events;
};

TEST_F(VirtualRobotTest, ServesThePageAndGreetsWithJointsAndSeat) {
  httplib::Client client("127.0.0.1", robot.port());
  for (const char* path :
       {"/", "/app.js", "/robot.js", "/body.js", "/table.js", "/texts.js", "/style.css", "/icon.svg"}) {
    const auto result = client.Get(path);
    ASSERT_TRUE(result) << path;
    EXPECT_EQ(result->status, 200) << path;
    EXPECT_THAT(result->get_header_value("Content-Security-Policy"), HasSubstr("default-src 'self'"));
  }
  Listener listener(robot.port());
  ASSERT_TRUE(Until([&] { return !listener.Find("hello").is_null(); }));
  const json hello = listener.Find("hello");
  EXPECT_EQ(hello["joints"].size(), 12u);
  EXPECT_EQ(hello["joints"][0]["name"], "HeadYaw");
  EXPECT_EQ(hello["robot"]["position"], json::parse("[0, -0.5, 0.08]"));
}

TEST_F(VirtualRobotTest, SpeechIsRenderedOfferedAndEndsByItself) {
  if (InstalledVoices().empty()) GTEST_SKIP() << "espeak-ng is not installed";
  Listener listener(robot.port());
  robot.Say({17, "Γεια σου!", "el"});
  ASSERT_TRUE(Until([&] { return !listener.Find("say").is_null(); }));
  const json say = listener.Find("say");
  EXPECT_EQ(say["text"], "Γεια σου!");
  EXPECT_GT(say["seconds"].get<double>(), 0.3);
  httplib::Client client("127.0.0.1", robot.port());
  const auto wav = client.Get(say["audio"].get<std::string>());
  ASSERT_TRUE(wav);
  const RenderedSpeech sound = ReadWav(wav->body);
  EXPECT_NEAR(sound.seconds(), say["seconds"].get<double>(), 0.01);
  int loudest = 0;
  for (const int16_t sample : sound.samples) loudest = std::max(loudest, std::abs(int{sample}));
  EXPECT_GT(loudest, 3000);
  ASSERT_TRUE(Until([&] { return !events.empty(); }));
  EXPECT_EQ(events[0].kind, BackEndEvent::Kind::kSpeechDone);
  EXPECT_EQ(events[0].id, 17);
}

TEST_F(VirtualRobotTest, PageThatSpeaksSaysWhenItIsDone) {
  Listener listener(robot.port());
  robot.Say({5, "A sentence that lasts for quite a while, or so it seems to me.", "en"});
  ASSERT_TRUE(Until([&] { return !listener.Find("say").is_null(); }));
  EXPECT_EQ(Post(R"({"type": "speech_started", "id": 5, "client": "a"})"), 204);
  EXPECT_TRUE(events.empty());
  EXPECT_EQ(Post(R"({"type": "speech_done", "id": 5, "client": "a"})"), 204);
  const int64_t begun = Now();
  ASSERT_TRUE(Until([&] { return !events.empty(); }));
  EXPECT_LT(Now() - begun, 500000);
}

TEST_F(VirtualRobotTest, SilenceIsToldAtOnceAndNothingIsReportedOfTheCutSentence) {
  Listener listener(robot.port());
  robot.Say({5, "A sentence.", "en"});
  ASSERT_TRUE(Until([&] { return !listener.Find("say").is_null(); }));
  const int64_t begun = Now();
  robot.Silence();
  ASSERT_TRUE(Until([&] { return !listener.Find("silence").is_null(); }));
  EXPECT_LT(Now() - begun, 100000);
  Until([&] { return Now() - begun > 1500000; });
  EXPECT_TRUE(events.empty());
}

TEST_F(VirtualRobotTest, UnknownLanguageFailsWithAReason) {
  robot.Say({6, "?", "xx"});
  ASSERT_TRUE(Until([&] { return !events.empty(); }));
  EXPECT_EQ(events[0].kind, BackEndEvent::Kind::kSpeechFailed);
  EXPECT_THAT(events[0].reason, HasSubstr("'xx'"));
}

TEST_F(VirtualRobotTest, HelpButtonIsHeardAndNonsenseIsNot) {
  EXPECT_EQ(Post(R"({"type": "help"})"), 204);
  for (const char* body : {"", "{", "[]", "7", R"({"type": 7})", R"({"type": "dance"})"})
    EXPECT_EQ(Post(body), 400) << body;
  EXPECT_EQ(Post(std::string(100000, '[')), 413);
  EXPECT_EQ(Post(R"({"type": "help"})", {{"Origin", "http://evil.example"}}), 403);
  Until([&] { return !events.empty(); });
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].kind, BackEndEvent::Kind::kHelpTouched);
}

TEST_F(VirtualRobotTest, MovesAndSceneReachThePageAndNonFiniteNumbersDoNot) {
  Listener listener(robot.port());
  JointAngles goal = RestAngles();
  At(goal, Joint::kHeadYaw) = 0.5;
  robot.Move(SmoothPath({RestAngles(), goal}, 0.3));
  TableScene scene;
  scene.parts.resize(2);
  scene.parts[1].X_TP.translation().x() = std::nan("");
  robot.ShowScene(scene);
  ASSERT_TRUE(Until([&] { return !listener.Find("scene").is_null(); }));
  const json move = listener.Find("move");
  EXPECT_EQ(move["joints"], json::parse(R"(["HeadYaw"])"));
  EXPECT_EQ(move["angles"].back()[0], 0.5);
  EXPECT_EQ(listener.Find("scene")["parts"].size(), 1u);
}

TEST(ScreenServerTest, TokenIsAskedForAndRemembered) {
  VirtualRobotOptions options;
  options.port = 0;
  options.token = "a-long-enough-token";
  ScreenServer server(options);
  httplib::Client client("127.0.0.1", server.port());
  EXPECT_EQ(client.Get("/")->status, 403);
  EXPECT_EQ(client.Get("/?token=a-long-enough-tokem")->status, 403);
  const auto page = client.Get("/?token=a-long-enough-token");
  EXPECT_EQ(page->status, 200);
  const std::string cookie = page->get_header_value("Set-Cookie");
  EXPECT_THAT(cookie, HasSubstr("HttpOnly"));
  EXPECT_EQ(client.Get("/app.js", {{"Cookie", cookie.substr(0, cookie.find(';'))}})->status, 200);
}

TEST(ScreenServerTest, TooManyPagesAreRefused) {
  VirtualRobotOptions options;
  options.port = 0;
  options.max_pages = 2;
  ScreenServer server(options);
  Listener a(server.port()), b(server.port());
  while (server.attached() < 2) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  httplib::Client client("127.0.0.1", server.port());
  EXPECT_EQ(client.Get("/events")->status, 503);
}

TEST(ScreenServerTest, PortInUseIsOneClearError) {
  VirtualRobotOptions options;
  options.port = 0;
  ScreenServer server(options);
  options.port = server.port();
  try {
    ScreenServer second(options);
    FAIL() << "two servers on one port";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("can't listen at 127.0.0.1:" + std::to_string(options.port)));
  }
}

TEST(WavTest, RoundTripStereoAndStreamsOfUnknownLength) {
  RenderedSpeech speech;
  speech.samples = {1, -2, 300, 32767, -32768};
  EXPECT_EQ(ReadWav(WavFile(speech)).samples, speech.samples);
  std::string endless = WavFile(speech);
  for (size_t i = 40; i < 44; ++i) endless[i] = static_cast<char>(0xff);
  EXPECT_EQ(ReadWav(endless).samples, speech.samples);
  EXPECT_THROW(ReadWav("RIFF"), std::runtime_error);
  EXPECT_THROW(ReadWav(""), std::runtime_error);
  EXPECT_THROW(ReadWav(WavFile(speech).substr(0, 38)), std::runtime_error);
}

}  // namespace
}  // namespace coach
