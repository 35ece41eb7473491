#include "services/capture/frame_grabber.h"

#include <gmock/gmock.h>

#include <chrono>
#include <memory>

namespace coach {
namespace {

using Clock = std::chrono::steady_clock;
using testing::HasSubstr;
using namespace std::chrono_literals;

/// What fake sources do, one string a call of Next: "frame", "nothing", "broken", "lost", "end".
struct Script {
  std::vector<std::string> calls;
  bool recording = true;
  int64_t period = 10'000;  ///< us
};

class FakeSource final : public FrameSource {
 public:
  explicit FakeSource(Script script) : script_(std::move(script)) {}
  Outcome Next(Frame& frame, int timeout_ms) override {
    const std::string call = next_ < script_.calls.size() ? script_.calls[next_++]
                             : script_.recording          ? "end"
                                                          : "nothing";
    if (call == "lost") throw SourceLost("unplugged");
    frame.utime = frames_ * script_.period;
    if (call == "frame" || call == "broken") ++frames_;
    if (call == "broken") throw std::runtime_error("frame is broken");
    if (call == "frame") return Outcome::kFrame;
    if (call == "end") return Outcome::kEnd;
    std::this_thread::sleep_for(std::chrono::milliseconds(std::min(timeout_ms, 5)));
    return Outcome::kNothing;
  }
  bool is_recording() const override { return script_.recording; }
  double period_us() const override { return static_cast<double>(script_.period); }

 private:
  Script script_;
  size_t next_ = 0;
  int64_t frames_ = 0;
};

std::vector<std::string> Times(int n, const std::string& call) {
  return std::vector<std::string>(static_cast<size_t>(n), call);
}

FrameGrabber::OpenSource Opens(Script script) {
  return [script] { return std::make_unique<FakeSource>(script); };
}

/// Takes frames until the grabber has ended or `count` came, at most 5 s.
std::vector<Frame> TakeAll(FrameGrabber& grabber, size_t count = 1'000'000, std::chrono::milliseconds work = 0ms) {
  std::vector<Frame> frames;
  const auto deadline = Clock::now() + 5s;
  while (Clock::now() < deadline && frames.size() < count) {
    if (std::optional<Frame> frame = grabber.Take()) {
      frames.push_back(*frame);
      std::this_thread::sleep_for(work);
    } else if (grabber.ended()) {
      break;
    } else {
      std::this_thread::sleep_for(1ms);
    }
  }
  return frames;
}

TEST(FrameGrabber, LockstepGivesEveryFrameHoweverSlowTheReader) {
  GrabberOptions options;
  options.every_frame = true;
  options.utime_origin = 500;
  FrameGrabber grabber(Opens({Times(20, "frame")}), options, [] {});
  const std::vector<Frame> frames = TakeAll(grabber, 100, 3ms);
  ASSERT_EQ(frames.size(), 20U);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].utime, 500 + static_cast<int64_t>(i) * 10'000);
    EXPECT_EQ(frames[i].sequence, static_cast<int64_t>(i));
  }
  EXPECT_EQ(grabber.replaced(), 0);
  EXPECT_TRUE(grabber.ended());
}

TEST(FrameGrabber, RecordingsPlayAtTheirOwnRateTimesTheSpeed) {
  for (const double speed : {1.0, 4.0}) {
    GrabberOptions options;
    options.speed = speed;
    const auto begin = Clock::now();
    FrameGrabber grabber(Opens({Times(31, "frame")}), options, [] {});
    const size_t frames = TakeAll(grabber).size();
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    EXPECT_EQ(static_cast<int64_t>(frames) + grabber.replaced(), 31);
    EXPECT_GE(seconds, 0.29 / speed);
    EXPECT_LT(seconds, 0.3 / speed + 1);
  }
}

TEST(FrameGrabber, ASlowReaderGetsTheNewestAndTheRestIsCounted) {
  FrameGrabber grabber(Opens({Times(40, "frame")}), {}, [] {});
  const std::vector<Frame> frames = TakeAll(grabber, 100, 50ms);
  EXPECT_LT(frames.size(), 15U);
  EXPECT_EQ(static_cast<int64_t>(frames.size()) + grabber.replaced(), 40);
  EXPECT_EQ(grabber.grabbed(), 40);
  EXPECT_EQ(frames.back().sequence, 39);
}

TEST(FrameGrabber, TimeAndSequenceGrowAcrossLoops) {
  GrabberOptions options;
  options.every_frame = true;
  options.loop = true;
  FrameGrabber grabber(Opens({Times(5, "frame")}), options, [] {});
  const std::vector<Frame> frames = TakeAll(grabber, 17);
  ASSERT_EQ(frames.size(), 17U);
  for (size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].utime, static_cast<int64_t>(i) * 10'000);
    EXPECT_EQ(frames[i].sequence, static_cast<int64_t>(i));
  }
}

TEST(FrameGrabber, ALostCameraIsOpenedAgainForEver) {
  GrabberOptions options;
  options.retry_ms = 1;
  int opened = 0;
  FrameGrabber grabber(
      [&opened]() -> std::unique_ptr<FrameSource> {
        if (++opened % 2 == 0) throw SourceLost("no camera");
        return std::make_unique<FakeSource>(Script{{"frame", "lost"}, false, 1});
      },
      options, [] {});
  EXPECT_EQ(TakeAll(grabber, 5).size(), 5U);
  EXPECT_GE(opened, 9);
  EXPECT_FALSE(grabber.ended());
}

TEST(FrameGrabber, ASilentCameraIsOpenedAgainAndComplainedAbout) {
  GrabberOptions options;
  options.retry_ms = 60'000;
  options.timeout_ms = 30;
  FrameGrabber grabber(Opens({{"frame"}, false, 1}), options, [] {});
  EXPECT_EQ(TakeAll(grabber, 1).size(), 1U);
  const auto deadline = Clock::now() + 5s;
  while (grabber.complaint().empty() && Clock::now() < deadline) std::this_thread::sleep_for(1ms);
  EXPECT_THAT(grabber.complaint(), HasSubstr("no frames"));
}  // and does not wait a minute to end

TEST(FrameGrabber, ABrokenFrameIsADropNotTheEnd) {
  GrabberOptions options;
  options.every_frame = true;
  FrameGrabber grabber(Opens({{"frame", "broken", "frame"}}), options, [] {});
  EXPECT_EQ(TakeAll(grabber).size(), 2U);
  EXPECT_EQ(grabber.grabbed(), 3);
  EXPECT_EQ(grabber.replaced(), 1);
  EXPECT_FALSE(grabber.failure());
}

TEST(FrameGrabber, ASourceThatNeverWillBeIsAFailure) {
  FrameGrabber grabber([]() -> std::unique_ptr<FrameSource> { throw std::runtime_error("no such file"); }, {}, [] {});
  EXPECT_TRUE(TakeAll(grabber).empty());
  ASSERT_TRUE(grabber.failure());
  EXPECT_THROW(std::rethrow_exception(grabber.failure()), std::runtime_error);
}

}  // namespace
}  // namespace coach
