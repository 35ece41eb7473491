#include "common/bus/node.h"

#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "common/bus/messages.h"
#include "common/bus/process_facts.h"

namespace coach {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

NodeOptions Options(const std::string& url = "memq://") {
  NodeOptions options;
  options.service = "detector";
  options.station = "S";
  options.url = url;
  options.configuration = "station: S\n";
  options.period_ms = 5;
  return options;
}

operator_command_t Command(int64_t id, const std::string& station = "S") {
  OperatorCommand command;
  command.id = id;
  command.station = station;
  command.kind = OperatorKind::kResetTracker;
  return ToMessage(command);
}

/// Runs the node for so many steps.
void RunSteps(Node& node, int steps) {
  int done = 0;
  node.Run([&] {
    if (++done >= steps) node.Stop();
  });
}

TEST(Node, StopsWithinASecondOfSigterm) {
  for (const int signal : {SIGTERM, SIGINT}) {
    Node node(Options());
    std::thread killer([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      kill(getpid(), signal);
    });
    const int64_t begin = SteadyTime();
    node.Run([] {});
    EXPECT_LT(SteadyTime() - begin, 1'000'000);
    killer.join();
  }
}

TEST(Node, WakeRunsAStepAtOnce) {
  NodeOptions options = Options();
  options.period_ms = 10'000;
  Node node(options);
  std::thread waker([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    node.Wake();
  });
  const int64_t begin = SteadyTime();
  RunSteps(node, 1);
  EXPECT_LT(SteadyTime() - begin, 1'000'000);
  waker.join();
}

TEST(Node, PublishesHealthAndConfiguration) {
  Node node(Options());
  std::vector<service_health_t> healths;
  std::vector<config_t> configs;
  node.Subscribe<service_health_t>([&](const service_health_t& m) { healths.push_back(m); });
  node.Subscribe<config_t>([&](const config_t& m) { configs.push_back(m); });
  RunSteps(node, 4);
  ASSERT_EQ(healths.size(), 1U);
  EXPECT_EQ(healths[0].service, "detector");
  EXPECT_EQ(healths[0].station, "S");
  EXPECT_EQ(healths[0].pid, getpid());
  EXPECT_EQ(healths[0].state, service_health_t::STARTING);
  EXPECT_GT(healths[0].resident_bytes, 1'000'000);
  ASSERT_EQ(configs.size(), 1U);
  EXPECT_EQ(configs[0].yaml, "station: S\n");
  // printf 'station: S\n' | sha256sum
  EXPECT_EQ(configs[0].sha256, "a8bdf81872c1d88c477605afbe8c7778f7b74ee6488a4f737eb42760883cb926");
}

TEST(Node, CountsWhatItDoes) {
  Node node(Options());
  int step = 0;
  node.Run([&] {
    node.Received();
    if (step % 2)
      node.Answered(WallTime() - 20'000);
    else
      node.Dropped();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    if (++step == 10) node.Stop();
  });
  const service_health_t health = node.Health();
  EXPECT_EQ(health.received, 10);
  EXPECT_EQ(health.answered, 5);
  EXPECT_EQ(health.dropped, 5);
  EXPECT_EQ(health.state, service_health_t::OK);
  EXPECT_NEAR(health.latency_p50_ms, 20, 5);
}

TEST(Node, OperatorCommandsAreHandledOnceAndEchoed) {
  Node node(Options());
  std::vector<int64_t> handled;
  node.OnOperatorCommand([&](const OperatorCommand& c) { handled.push_back(c.id); });
  for (const int64_t id : {11, 11, 12, 11, 12}) node.Publish(Command(id));
  node.Publish(Command(13, "OTHER"));
  RunSteps(node, 3);
  EXPECT_THAT(handled, ElementsAre(11, 12));
  EXPECT_EQ(node.Health().last_operator_command, 12);
  EXPECT_EQ(node.Health().decode_errors, 1);
}

TEST(Node, AFailingStepIsCountedAndDoesNotEndTheService) {
  Node node(Options());
  int steps = 0;
  node.Run([&] {
    if (++steps == 5) node.Stop();
    throw std::runtime_error("no luck");
  });
  EXPECT_EQ(steps, 5);
  const service_health_t health = node.Health();
  EXPECT_EQ(health.decode_errors, 5);
  EXPECT_EQ(health.state, service_health_t::DEGRADED);
}

TEST(Node, SaysWhenNoInputComes) {
  NodeOptions options = Options();
  options.expects_frames = true;
  Node node(options);
  EXPECT_EQ(node.Health().state, service_health_t::DEGRADED);
  EXPECT_THAT(node.Health().message, HasSubstr("no input"));
  node.Received();
  EXPECT_EQ(node.Health().message, "");
}

TEST(Node, NoticesASecondServiceOfItsName) {
  Node node(Options());
  service_health_t rival = node.Health();
  rival.host = "elsewhere";
  node.Publish(rival);
  RunSteps(node, 2);
  EXPECT_EQ(node.Health().state, service_health_t::DEGRADED);
  EXPECT_THAT(node.Health().message, HasSubstr("elsewhere"));
}

TEST(Node, LockstepPublishesNoWallTime) {
  const std::string in = testing::TempDir() + "/coach_node_in.lcm", out = testing::TempDir() + "/coach_node_out.lcm";
  std::filesystem::remove(in);
  std::filesystem::remove(out);
  PartPoses poses;
  poses.received_utime = 99;
  {
    Bus writer("file://" + in + "?mode=w", "S");
    for (poses.utime = 1; poses.utime <= 20; ++poses.utime) writer.Publish(ToMessage(poses));
  }
  {
    NodeOptions options = Options("file://" + in + "?speed=0");
    options.output_url = "file://" + out + "?mode=w";
    Node node(options);
    EXPECT_EQ(node.Now(), 0);
    int64_t pending = 0;
    node.SubscribeNewest<part_poses_t>([&](const part_poses_t& m) { pending = m.utime; });
    node.Run([&] {
      if (!pending) return;
      poses.utime = pending * 10;
      node.Publish(ToMessage(poses));
      pending = 0;
    });
  }
  Bus reader("file://" + out + "?speed=0", "S");
  std::vector<int64_t> seen;
  reader.Subscribe<part_poses_t>([&](const part_poses_t& m) {
    seen.push_back(m.utime);
    EXPECT_EQ(m.received_utime, 0);
  });
  int configs = 0, healths = 0;
  reader.Subscribe<config_t>([&](const config_t&) { ++configs; });
  reader.Subscribe<service_health_t>([&](const service_health_t&) { ++healths; });
  while (reader.Handle(100) >= 0) {
  }
  ASSERT_EQ(seen.size(), 20U);
  EXPECT_EQ(seen.back(), 200);
  EXPECT_EQ(configs, 1);
  EXPECT_EQ(healths, 0);
}

/// A socket as systemd's.
class NotifySocket {
 public:
  NotifySocket() {
    path_ = testing::TempDir() + "/coach_notify_" + std::to_string(getpid());
    std::filesystem::remove(path_);
    fd_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    EXPECT_EQ(bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
    setenv("WATCHDOG_USEC", "60000", 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
    close(fd_);
    std::filesystem::remove(path_);
  }
  std::vector<std::string> Words() const {
    std::vector<std::string> words;
    char buffer[256];
    for (ssize_t n; (n = recv(fd_, buffer, sizeof buffer, 0)) > 0;) words.emplace_back(buffer, static_cast<size_t>(n));
    return words;
  }

 private:
  std::string path_;
  int fd_;
};

TEST(Node, TellsSystemdFromItsLoopOnly) {
  const NotifySocket systemd;
  Node node(Options());
  EXPECT_TRUE(systemd.Words().empty());
  int steps = 0;
  node.Run([&] {
    if (++steps == 20) {
      const std::vector<std::string> words = systemd.Words();
      ASSERT_GE(words.size(), 3U);
      EXPECT_EQ(words[0], "READY=1");
      EXPECT_EQ(words[1], "WATCHDOG=1");
      std::this_thread::sleep_for(std::chrono::milliseconds(200));  // a step that hangs
      EXPECT_TRUE(systemd.Words().empty());
      node.Stop();
    }
  });
  EXPECT_THAT(systemd.Words(), ElementsAre("WATCHDOG=1", "STOPPING=1"));
}

}  // namespace
}  // namespace coach
