// The chain over UDP: it answers, survives the death of any of its services and hostile messages, and ends when asked
// to.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <functional>

#include "common/bus/bus.h"
#include "common/bus/process_facts.h"
#include "process.h"
#include "tiny_scene.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr char kUrl[] = "udpm://239.255.76.67:7667?ttl=0";

/// Sends raw bytes to the network.
void SendPackets(const std::string& bytes, int count) {
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(7667);
  inet_pton(AF_INET, "239.255.76.67", &to.sin_addr);
  for (int i = 0; i < count; ++i) {
    sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  close(fd);
}

class LiveChain : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / ("coach_live_" + std::to_string(getpid()));
    WriteTinyScene(folder_, 40);
  }
  static void TearDownTestSuite() { fs::remove_all(folder_); }

  LiveChain() : bus_(kUrl, "S") {
    bus_.Subscribe<part_poses_t>([this](const part_poses_t& m) {
      EXPECT_GT(m.utime, last_utime_) << "time goes backwards";
      last_utime_ = m.utime;
      ++poses_;
    });
    bus_.Subscribe<service_health_t>([this](const service_health_t& m) { health_[m.service] = m; });
  }

  Process Capture(const std::string& station = "S", const std::string& origin = "0") const {
    return Process({Program("coach-capture"), "--station", station, "--source", "scene:" + folder_.string(), "--fps",
                    "30", "--loop", "--utime-origin", origin});
  }
  Process Detector() const {
    return Process({Program("coach-detector"), "--station", "S", "--task", (folder_ / "task.yaml").string()});
  }
  Process Filter() const {
    return Process({Program("coach-pose-filter"), "--station", "S", "--task", (folder_ / "task.yaml").string()});
  }

  /// Listens until `done` or so many seconds. @returns done()
  bool Listen(double seconds, const std::function<bool()>& done) {
    for (const int64_t end = SteadyTime() + static_cast<int64_t>(seconds * 1e6); !done() && SteadyTime() < end;)
      bus_.Handle(20);
    return done();
  }
  /// So many more PART_POSES come within 10 s.
  bool Answers(int more) {
    const int64_t wanted = poses_ + more;
    return Listen(10, [&] { return poses_ >= wanted; });
  }

  static inline fs::path folder_;
  Bus bus_;
  int64_t poses_ = 0, last_utime_ = -1;
  std::map<std::string, service_health_t> health_;
};

TEST_F(LiveChain, AnswersEveryFrameAndEndsWithinASecond) {
  std::vector<Process> services;
  services.push_back(Filter());
  services.push_back(Detector());
  services.push_back(Capture());
  ASSERT_TRUE(Answers(60));
  EXPECT_TRUE(Listen(5, [&] { return health_.size() == 3 && health_["pose-filter"].answered >= 60; }));
  const service_health_t& filter = health_["pose-filter"];
  EXPECT_EQ(filter.state, service_health_t::OK) << filter.message;
  EXPECT_LE(filter.received - filter.answered - filter.dropped, 1);
  EXPECT_EQ(filter.decode_errors, 0);
  EXPECT_GT(filter.latency_p50_ms, 0);
  for (Process& service : services) {
    service.Signal(SIGTERM);
    const int64_t begin = SteadyTime();
    EXPECT_EQ(service.Wait(3), 0) << service.output();
    EXPECT_LT(SteadyTime() - begin, 1'000'000);
  }
}

TEST_F(LiveChain, SurvivesTheDeathOfDetectorAndFilter) {
  const Process capture = Capture();
  std::optional<Process> detector(Detector()), filter(Filter());
  ASSERT_TRUE(Answers(10));
  detector->Signal(SIGKILL);
  EXPECT_TRUE(Answers(5)) << "the filter goes on without regions";
  detector.emplace(Detector());
  EXPECT_TRUE(Answers(20));
  filter->Signal(SIGKILL);
  filter->Wait(1);
  bus_.Handle(100);
  const int64_t before = poses_;
  EXPECT_FALSE(Listen(0.5, [&] { return poses_ > before; }));
  filter.emplace(Filter());
  EXPECT_TRUE(Answers(20));
}

TEST_F(LiveChain, ReasonerAndBridgeDieAndComeBack) {
  const Process capture = Capture(), detector = Detector(), filter = Filter();
  const auto start = [](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{Program("coach-" + name), "--station", "S", "--task",
                                       (folder_ / "task.yaml").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Process(arguments);
  };
  const std::vector<std::string> log_robot{"--back-end", "log"};
  std::optional<Process> reasoner(start("assembly-reasoner", {})), bridge(start("robot-bridge", log_robot));
  ASSERT_TRUE(Listen(10, [&] { return health_.contains("assembly-reasoner") && health_.contains("robot-bridge"); }))
      << reasoner->output() << bridge->output();
  const int32_t old_reasoner = health_["assembly-reasoner"].pid, old_bridge = health_["robot-bridge"].pid;
  reasoner->Signal(SIGKILL);
  bridge->Signal(SIGKILL);
  EXPECT_TRUE(Answers(20));
  reasoner.emplace(start("assembly-reasoner", {}));
  bridge.emplace(start("robot-bridge", log_robot));
  EXPECT_TRUE(Listen(10, [&] {
    return health_["assembly-reasoner"].pid != old_reasoner && health_["robot-bridge"].pid != old_bridge;
  }));
  EXPECT_TRUE(Answers(20));
  for (Process* service : {&*reasoner, &*bridge}) {
    service->Signal(SIGTERM);
    EXPECT_EQ(service->Wait(1), 0) << service->output();
  }
}

TEST_F(LiveChain, FollowsACameraThatWasStartedAgain) {
  const Process detector = Detector(), filter = Filter();
  std::optional<Process> capture(Capture("S", "100000000"));
  ASSERT_TRUE(Answers(30));
  capture->Signal(SIGKILL);
  capture->Wait(1);
  EXPECT_TRUE(Listen(4, [&] { return health_["pose-filter"].state == service_health_t::DEGRADED; }));
  EXPECT_THAT(health_["pose-filter"].message, HasSubstr("no input"));
  last_utime_ = -1;
  capture.emplace(Capture());
  EXPECT_TRUE(Answers(20));
  EXPECT_LT(last_utime_, 50'000'000);
}

TEST_F(LiveChain, HostileMessagesAreCountedAndNothingElse) {
  Process detector = Detector(), filter = Filter();
  const Process capture = Capture();
  ASSERT_TRUE(Answers(10));
  const std::vector<uint8_t> garbage(3000, 0xff);
  SendPackets("LC02....S/DETECTIONS", 100);  // ends before the channel's name does
  for (const char* channel :
       {"COLOR_IMAGE", "DEPTH_IMAGE", "DETECTIONS", "CONNECTION_BELIEF", "OPERATOR_COMMAND", "SERVICE_HEALTH"}) {
    for (size_t size = 1; size < garbage.size(); size += 297)
      bus_.PublishBytes(channel, std::span(garbage).first(size));
  }
  EXPECT_TRUE(Answers(40));
  EXPECT_TRUE(
      Listen(3, [&] { return health_["pose-filter"].decode_errors >= 40 && health_["detector"].decode_errors >= 30; }));
  EXPECT_TRUE(detector.running());
  EXPECT_TRUE(filter.running());
}

TEST_F(LiveChain, ASecondServiceOfTheSameNameIsNoticed) {
  const Process one = Capture(), two = Capture();
  EXPECT_TRUE(Listen(6, [&] { return health_["capture"].message.find("another capture") != std::string::npos; }));
  EXPECT_EQ(health_["capture"].state, service_health_t::DEGRADED);
}

TEST_F(LiveChain, AnotherStationIsNotHeard) {
  const Process detector = Detector(), filter = Filter(), other = Capture("T");
  Bus other_bus(kUrl, "T");
  int frames = 0;
  other_bus.SubscribeNewest<color_image_t>([&](const color_image_t&) { ++frames; });
  EXPECT_TRUE(Listen(5, [&] {
    other_bus.Handle(0);
    return frames > 20;
  }));
  EXPECT_EQ(poses_, 0);
}

}  // namespace
}  // namespace coach
