#include "services/pose_filter/pose_filter_service.h"

#include <gmock/gmock.h>

#include <opencv2/core.hpp>

#include "common/bus/image_messages.h"
#include "common/bus/messages.h"

namespace coach {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

/// What reached the filter, in a line a call.
class RecordingFilter final : public PoseFilter {
 public:
  explicit RecordingFilter(std::vector<std::string>& calls) : calls_(calls) {}
  const PartPoses& Step(const FilterInput& input) override {
    std::string call = "step " + std::to_string(input.utime);
    if (input.detections) call += " regions " + std::to_string(input.detections->utime);
    if (input.colour.empty()) call += " without colour";
    if (input.belief) call += " belief " + std::to_string(input.belief->utime);
    calls_.push_back(call);
    poses_ = PartPoses();
    poses_.utime = input.utime;
    poses_.received_utime = input.received_utime;
    poses_.parts.resize(1);
    poses_.parts[0].status = PartStatus::kTracked;
    return poses_;
  }
  void Reset() override { calls_.push_back("reset"); }
  void Suggest(const std::vector<Pose>& X_CP) override { calls_.push_back("suggest " + std::to_string(X_CP.size())); }

 private:
  std::vector<std::string>& calls_;
  PartPoses poses_;
};

class PoseFilterServiceTest : public testing::Test {
 protected:
  PoseFilterServiceTest()
      : in_(testing::TempDir() + "/coach_filter_in.lcm"), out_(testing::TempDir() + "/coach_filter_out.lcm") {
    fs::remove(in_);
    fs::remove(out_);
    log_ = std::make_unique<Bus>("file://" + in_ + "?mode=w", "S");
    task_.parts = {{"a_1", 0}};
  }

  static Frame MakeFrame(int64_t utime) {
    Frame frame;
    frame.utime = utime;
    frame.received_utime = 77;
    frame.camera = {4, 3, 5, 5, 2, 1, {}};
    frame.depth = cv::Mat(3, 4, CV_16UC1, cv::Scalar(700));
    frame.colour = cv::Mat(3, 4, CV_8UC3, cv::Scalar(1, 2, 3));
    return frame;
  }
  /// Both images of a frame, as capture sends them.
  void PutImages(int64_t utime) {
    log_->Publish(ToColourMessage(MakeFrame(utime), ColourEncoding::kRgb8, 95));
    log_->Publish(ToDepthMessage(MakeFrame(utime), DepthEncoding::kZstd));
  }
  void PutRegions(int64_t utime) {
    Detections detections;
    detections.utime = utime;
    log_->Publish(ToMessage(detections));
  }
  void PutBelief(int64_t utime) { log_->Publish(ToMessage(ConnectionBelief{utime, {}})); }

  /// Works through what was put. @returns what reached the filter.
  std::vector<std::string> Replay() {
    log_.reset();
    NodeOptions node;
    node.service = "pose-filter";
    node.station = "S";
    node.url = "file://" + in_ + "?speed=0";
    node.output_url = "file://" + out_ + "?mode=w";
    std::vector<std::string> calls;
    PoseFilterService service(node, task_, [&](const Task&) { return std::make_unique<RecordingFilter>(calls); }, {});
    service.Run();
    health_ = service.node().Health();
    return calls;
  }

  std::string in_, out_;
  std::unique_ptr<Bus> log_;
  Task task_;
  service_health_t health_;
};

TEST_F(PoseFilterServiceTest, StepsOnceAFrameWithWhatIsThere) {
  PutImages(10);
  PutRegions(10);
  PutImages(20);
  PutImages(30);  // 20 goes without
  PutRegions(30);
  EXPECT_THAT(Replay(), ElementsAre("step 10 regions 10", "step 20", "step 30 regions 30"));
  EXPECT_EQ(health_.received, 3);
  EXPECT_EQ(health_.answered, 3);
  EXPECT_EQ(health_.dropped, 0);
}

TEST_F(PoseFilterServiceTest, GoesWithoutColourOnceTheNextFrameHasCome) {
  log_->Publish(ToDepthMessage(MakeFrame(10), DepthEncoding::kZstd));
  PutRegions(10);
  PutImages(20);
  PutRegions(20);
  EXPECT_THAT(Replay(), ElementsAre("step 10 regions 10 without colour", "step 20 regions 20"));
}

TEST_F(PoseFilterServiceTest, AnswersWithPosesOfTheFramesTimeAndNoWallTime) {
  PutImages(10);
  PutRegions(10);
  Replay();
  Bus reader("file://" + out_ + "?speed=0", "S");
  int answers = 0;
  reader.Subscribe<part_poses_t>([&](const part_poses_t& m) {
    ++answers;
    EXPECT_EQ(m.utime, 10);
    EXPECT_EQ(m.received_utime, 0);
  });
  while (reader.Handle(100) >= 0) {
  }
  EXPECT_EQ(answers, 1);
}

TEST_F(PoseFilterServiceTest, ABeliefIsUsedForFiveFrames) {
  PutImages(10);
  PutRegions(10);
  PutBelief(10);
  for (int64_t t = 20; t <= 70; t += 10) {
    PutImages(t);
    PutRegions(t);
  }
  EXPECT_THAT(Replay(),
              ElementsAre("step 10 regions 10", "step 20 regions 20 belief 10", "step 30 regions 30 belief 10",
                          "step 40 regions 40 belief 10", "step 50 regions 50 belief 10",
                          "step 60 regions 60 belief 10", "step 70 regions 70"));
}

TEST_F(PoseFilterServiceTest, TheOperatorResetsIt) {
  OperatorCommand command;
  command.id = 5;
  command.station = "S";
  command.kind = OperatorKind::kResetTracker;
  log_->Publish(ToMessage(command));
  log_->Publish(ToMessage(command));  // repeated until echoed
  PutImages(10);
  PutRegions(10);
  EXPECT_THAT(Replay(), ElementsAre("reset", "step 10 regions 10"));
  EXPECT_EQ(health_.last_operator_command, 5);
}

TEST_F(PoseFilterServiceTest, ACameraThatWasStartedAgainIsFollowedFromItsPoses) {
  PutImages(90'000'000);
  PutRegions(90'000'000);
  for (int64_t t = 10; t <= 40; t += 10) {
    PutImages(t);
    PutRegions(t);
  }
  EXPECT_THAT(Replay(), ElementsAre("step 90000000 regions 90000000", "reset", "suggest 1", "step 30 regions 30",
                                    "step 40 regions 40"));
}

TEST_F(PoseFilterServiceTest, ABrokenImageIsACountedDrop) {
  log_->Publish(ToColourMessage(MakeFrame(10), ColourEncoding::kRgb8, 95));
  depth_image_t broken = ToDepthMessage(MakeFrame(10), DepthEncoding::kZstd);
  broken.data[0] ^= 0xff;
  log_->Publish(broken);
  PutRegions(10);
  PutImages(20);
  PutRegions(20);
  EXPECT_THAT(Replay(), ElementsAre("step 20 regions 20"));
  EXPECT_EQ(health_.dropped, 1);
  EXPECT_EQ(health_.answered, 1);
  EXPECT_EQ(health_.decode_errors, 1);
}

}  // namespace
}  // namespace coach
