#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <thread>

#include "fake_qi_server.h"
#include "services/robot_bridge/qi/session.h"

namespace coach::qi {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

SessionOptions OptionsFor(const std::string& url) {
  SessionOptions options;
  options.url = url;
  options.call_timeout_us = 1000000;
  options.connect_timeout_us = 2000000;
  options.first_pause_us = 50000;
  options.longest_pause_us = 200000;
  return options;
}

Result CallAndWait(Session& session, const std::string& service, const std::string& method, List arguments,
                   double seconds = 5) {
  Result result{false, {}, "nothing happened"};
  bool done = false;
  session.Call(service, method, std::move(arguments), [&](const Result& got) {
    result = got;
    done = true;
  });
  Until(
      seconds, [&] { session.Poll(SteadyNow()); }, [&] { return done; });
  EXPECT_TRUE(done);
  return result;
}

bool Connect(Session& session, double seconds = 5) {
  return Until(
      seconds, [&] { session.Poll(SteadyNow()); }, [&] { return session.connected(); });
}

TEST(QiSessionTest, CallsOverloadsAndErrors) {
  const FakeQiServer server;
  Session session(OptionsFor(server.url()));
  ASSERT_TRUE(Connect(session)) << session.problem();
  EXPECT_EQ(CallAndWait(session, "ALSystem", "systemVersion", {}).value.Text(), "2.8.6.23");
  const Result limits = CallAndWait(session, "ALMotion", "getLimits", {"HeadYaw"});
  ASSERT_TRUE(limits.ok) << limits.error;
  EXPECT_NEAR(limits.value.Items()[0].Items()[1].Number(), 2.0857, 1e-6);
  EXPECT_TRUE(CallAndWait(session, "ALLeds", "fadeRGB", {"FaceLeds", 0x2d73e6, 0.3}).ok);
  EXPECT_EQ(server.LastArguments("ALLeds.fadeRGB")[1], 0x2d73e6);
  EXPECT_TRUE(CallAndWait(session, "ALTextToSpeech", "say", {"Γεια"}).ok);
  EXPECT_EQ(server.LastArguments("ALTextToSpeech.say")[0], "Γεια");
  EXPECT_THAT(CallAndWait(session, "ALTextToSpeech", "sing", {}).error, HasSubstr("no method 'sing'"));
  EXPECT_THAT(CallAndWait(session, "ALNothing", "x", {}).error, HasSubstr("ALNothing"));
  EXPECT_THAT(server.Violations(), IsEmpty());
}

TEST(QiSessionTest, HangingCallTimesOutAndAFailingOneTellsWhy) {
  FakeQiServer server;
  Session session(OptionsFor(server.url()));
  ASSERT_TRUE(Connect(session));
  server.Order("hang ALMotion.rest");
  server.Order("fail ALMotion.killAll");
  // Orders reach the server by another way than calls: give them time.
  Until(
      0.3, [&] { session.Poll(SteadyNow()); }, [] { return false; });
  EXPECT_THAT(CallAndWait(session, "ALMotion", "rest", {}).error, HasSubstr("no answer within 1000 ms"));
  EXPECT_EQ(CallAndWait(session, "ALMotion", "killAll", {}).error, "ALMotion.killAll has failed");
  EXPECT_TRUE(CallAndWait(session, "ALSystem", "systemVersion", {}).ok);
}

TEST(QiSessionTest, EventsComeThroughMemory) {
  FakeQiServer server;
  Session session(OptionsFor(server.url()));
  ASSERT_TRUE(Connect(session));
  std::vector<double> touches;
  bool listening = false;
  session.Listen(
      "FrontTactilTouched", [&](const Value& value) { touches.push_back(value.Number()); },
      [&](const Result& result) { listening = result.ok; });
  const auto poll = [&] { session.Poll(SteadyNow()); };
  ASSERT_TRUE(Until(5, poll, [&] { return listening; }));
  server.Order("touch 1");
  server.Order("touch 0");
  EXPECT_TRUE(Until(5, poll, [&] { return touches.size() == 2; }));
  EXPECT_EQ(touches, (std::vector<double>{1, 0}));
}

TEST(QiSessionTest, ServiceOfAnotherProcessGetsAConnectionOfItsOwn) {
  const FakeQiServer server({"--two-processes"});
  Session session(OptionsFor(server.url()));
  ASSERT_TRUE(Connect(session));
  EXPECT_TRUE(CallAndWait(session, "ALMotion", "rest", {}).ok);
  EXPECT_TRUE(CallAndWait(session, "ALSystem", "systemVersion", {}).ok);
}

TEST(QiSessionTest, NewerDirectoryWithBinaryUid) {
  const FakeQiServer server({"--seven"});
  Session session(OptionsFor(server.url()));
  ASSERT_TRUE(Connect(session));
  EXPECT_TRUE(CallAndWait(session, "ALMotion", "rest", {}).ok);
}

TEST(QiSessionTest, LoginIsGivenAndRefused) {
  const FakeQiServer server({"--user", "nao", "--token", "secret"});
  SessionOptions options = OptionsFor(server.url());
  options.user = "nao";
  options.token = "secret";
  Session good(options);
  EXPECT_TRUE(Connect(good)) << good.problem();
  EXPECT_TRUE(CallAndWait(good, "ALSystem", "systemVersion", {}).ok);
  options.token = "wrong";
  Session bad(options);
  EXPECT_FALSE(Connect(bad, 1));
  EXPECT_THAT(bad.problem(), HasSubstr("login refused"));
}

TEST(QiSessionTest, ServerWithoutLogin) {
  const FakeQiServer server({"--no-authenticate"});
  Session open(OptionsFor(server.url()));
  EXPECT_TRUE(Connect(open)) << open.problem();
  EXPECT_TRUE(CallAndWait(open, "ALSystem", "systemVersion", {}).ok);
  SessionOptions options = OptionsFor(server.url());
  options.user = "nao";
  Session asks(options);
  EXPECT_FALSE(Connect(asks, 1));
  EXPECT_THAT(asks.problem(), HasSubstr("login"));
}

TEST(QiSessionTest, CapabilitiesOfTheirOwnAccordAreNoAnswerToALogin) {
  const FakeQiServer server({"--user", "nao", "--token", "secret", "--capability-first"});
  SessionOptions options = OptionsFor(server.url());
  options.user = "nao";
  options.token = "secret";
  Session good(options);
  EXPECT_TRUE(Connect(good)) << good.problem();
  options.token = "wrong";
  Session bad(options);
  EXPECT_FALSE(Connect(bad, 1));
  EXPECT_THAT(bad.problem(), HasSubstr("login refused: authentication failed"));
  EXPECT_THAT(server.Violations(), IsEmpty());
}

TEST(QiSessionTest, LoginOfTwoRoundsWithANewToken) {
  const FakeQiServer server({"--user", "nao", "--token", "secret", "--two-rounds"});
  SessionOptions options = OptionsFor(server.url());
  options.user = "nao";
  options.token = "secret";
  Session session(options);
  ASSERT_TRUE(Connect(session)) << session.problem();
  EXPECT_TRUE(CallAndWait(session, "ALSystem", "systemVersion", {}).ok);
  EXPECT_THAT(server.Violations(), IsEmpty());
}

TEST(QiSessionTest, UnknownTypesFlagsAndAnswersToNobodyAreIgnored) {
  const FakeQiServer server({"--odd-messages"});
  Session session(OptionsFor(server.url()));
  ASSERT_TRUE(Connect(session)) << session.problem();
  EXPECT_EQ(CallAndWait(session, "ALSystem", "systemVersion", {}).value.Text(), "2.8.6.23");
  EXPECT_EQ(session.generation(), 1);
}

TEST(QiSessionTest, AServiceThatNobodyCanReachDoesNotTakeTheOthersAlong) {
  const FakeQiServer server({"--ghost", "ALBattery"});
  Session session(OptionsFor(server.url()));
  ASSERT_TRUE(Connect(session));
  EXPECT_TRUE(CallAndWait(session, "ALMotion", "rest", {}).ok);
  for (int i = 0; i < 3; ++i) {
    EXPECT_THAT(CallAndWait(session, "ALBattery", "getBatteryCharge", {}).error, HasSubstr("127.0.0.1:1"));
    EXPECT_TRUE(CallAndWait(session, "ALMotion", "rest", {}).ok);
  }
  EXPECT_EQ(session.generation(), 1);
}

TEST(QiSessionTest, ARobotThatFreezesIsNoticedAHangingCallIsNoFreeze) {
  FakeQiServer server;
  SessionOptions options = OptionsFor(server.url());
  options.call_timeout_us = 200000;
  Session session(options);
  ASSERT_TRUE(Connect(session));
  server.Order("hang ALMotion.rest");
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(CallAndWait(session, "ALMotion", "rest", {}).ok);
  EXPECT_TRUE(session.connected()) << "the rest of the robot answers";
  server.Order("freeze");
  const auto poll = [&] { session.Poll(SteadyNow()); };
  Until(0.2, poll, [] { return false; });
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(CallAndWait(session, "ALMotion", "rest", {}).ok);
  EXPECT_TRUE(Until(2, poll, [&] { return !session.connected(); }));
  EXPECT_THAT(session.problem(), HasSubstr("does not answer any more"));
}

TEST(QiSessionTest, HalfAMessageAndTheEndStartAnew) {
  FakeQiServer server;
  Session session(OptionsFor(server.url()));
  ASSERT_TRUE(Connect(session));
  server.Order("cut");
  const auto poll = [&] { session.Poll(SteadyNow()); };
  EXPECT_TRUE(Until(3, poll, [&] { return session.generation() == 2 && session.connected(); }));
  EXPECT_TRUE(CallAndWait(session, "ALMotion", "rest", {}).ok);
}

/// Certificate and key for the fake robot; nothing without an openssl program.
std::optional<std::vector<std::string>> TlsArguments(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  const std::string certificate = folder / "cert.pem", key = folder / "key.pem";
  const std::string command = "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=nao -keyout " + key +
                              " -out " + certificate + " 2>/dev/null";
  if (std::system(command.c_str()) != 0) return std::nullopt;
  return std::vector<std::string>{"--tls", certificate, key, "--user", "nao", "--token", "t"};
}

TEST(QiSessionTest, TlsRobotThatIsKilledAndRestarted) {
  const auto folder = std::filesystem::temp_directory_path() / ("coach_qi_kill_" + std::to_string(getpid()));
  auto arguments = TlsArguments(folder);
  if (!arguments) GTEST_SKIP() << "no openssl program to make a certificate";
  auto server = std::make_unique<FakeQiServer>(*arguments);
  SessionOptions options = OptionsFor("tcps://127.0.0.1:" + std::to_string(server->port()));
  options.user = "nao";
  options.token = "t";
  Session session(options);
  ASSERT_TRUE(Connect(session)) << session.problem();
  ASSERT_TRUE(CallAndWait(session, "ALMotion", "rest", {}).ok);
  const std::string port = std::to_string(server->port());
  server->Kill();
  for (int i = 0; i < 20; ++i) {  // written to who is no more
    session.Call("ALMotion", "rest", {}, [](const Result&) {});
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  arguments->insert(arguments->end(), {"--port", port});
  server = std::make_unique<FakeQiServer>(*arguments);
  EXPECT_TRUE(Until(
      5, [&] { session.Poll(SteadyNow()); }, [&] { return session.connected() && session.generation() == 2; }));
  EXPECT_TRUE(CallAndWait(session, "ALMotion", "rest", {}).ok);
  std::filesystem::remove_all(folder);
}

TEST(QiSessionTest, Tls) {
  const auto folder = std::filesystem::temp_directory_path() / ("coach_qi_tls_" + std::to_string(getpid()));
  const auto arguments = TlsArguments(folder);
  if (!arguments) GTEST_SKIP() << "no openssl program to make a certificate";
  const FakeQiServer server(*arguments);
  SessionOptions options = OptionsFor("tcps://127.0.0.1:" + std::to_string(server.port()));
  options.user = "nao";
  options.token = "t";
  Session session(options);
  EXPECT_TRUE(Connect(session)) << session.problem();
  EXPECT_TRUE(CallAndWait(session, "ALSystem", "systemVersion", {}).ok);
  Session plain(OptionsFor(server.url()));
  EXPECT_FALSE(Connect(plain, 1));
  std::filesystem::remove_all(folder);
}

TEST(QiSessionTest, UnknownHostRefusedPortAndGarbage) {
  Session unknown(OptionsFor("tcp://no-such-robot.invalid:9559"));
  EXPECT_FALSE(Connect(unknown, 1));
  EXPECT_THAT(unknown.problem(), HasSubstr("no-such-robot.invalid"));
  Session refused(OptionsFor("tcp://127.0.0.1:1"));
  EXPECT_FALSE(Connect(refused, 0.5));
  EXPECT_THAT(refused.problem(), HasSubstr("127.0.0.1:1"));
  EXPECT_THROW(Session(OptionsFor("nao.local")), std::invalid_argument);
  Result result{true, {}, ""};
  refused.Call("ALSystem", "systemVersion", {}, [&](const Result& got) { result = got; });
  EXPECT_FALSE(result.ok);
}

TEST(QiSessionTest, ReconnectsToARobotThatWasRestartedWithOtherIds) {
  auto server = std::make_unique<FakeQiServer>(std::vector<std::string>{"--seed", "1"});
  const std::string port = std::to_string(server->port());
  Session session(OptionsFor(server->url()));
  ASSERT_TRUE(Connect(session));
  EXPECT_TRUE(CallAndWait(session, "ALMotion", "rest", {}).ok);
  const int64_t generation = session.generation();
  server->Order("hang ALMotion.rest");
  const auto poll = [&] { session.Poll(SteadyNow()); };
  Until(0.3, poll, [] { return false; });
  Result cut{true, {}, ""};
  session.Call("ALMotion", "rest", {}, [&](const Result& got) { cut = got; });
  Until(0.1, poll, [] { return false; });
  server->Kill();
  EXPECT_TRUE(Until(5, poll, [&] { return !session.connected() && !cut.ok; }));
  EXPECT_FALSE(cut.ok);
  EXPECT_THAT(cut.error, HasSubstr("lost"));
  server = std::make_unique<FakeQiServer>(std::vector<std::string>{"--seed", "2", "--port", port});
  ASSERT_TRUE(Connect(session));
  EXPECT_GT(session.generation(), generation);
  EXPECT_TRUE(CallAndWait(session, "ALMotion", "rest", {}).ok);
  EXPECT_THAT(server->Violations(), IsEmpty());
}

}  // namespace
}  // namespace coach::qi
