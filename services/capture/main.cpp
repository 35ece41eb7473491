// coach-capture: frames from a camera or a recording onto the bus.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdlib>

#include "common/bus/image_messages.h"
#include "common/bus/process_facts.h"
#include "common/bus/service_main.h"
#include "services/capture/frame_grabber.h"
#include "services/capture/image_budget.h"
#include "services/capture/open_source.h"

namespace coach {
namespace {

constexpr int64_t kHangs = 15'000'000;         // us; a camera's driver that doesn't come back for so long never will
constexpr int64_t kAnswerTimeout = 2'000'000;  // us; lockstep goes on without an answer after this

struct Arguments {
  std::string source;
  double fps = 0, speed = 1;
  bool lockstep = false, loop = false;
  int64_t utime_origin = 0;
};

CaptureOptions MakeOptions(const Station& station, const Arguments& arguments) {
  CaptureOptions options = ReadCaptureOptions(station.Section("camera"), station.file.parent_path());
  if (!arguments.source.empty()) options.source = arguments.source;
  if (arguments.fps > 0) options.fps = arguments.fps;
  options.speed = arguments.speed;
  options.lockstep = arguments.lockstep;
  options.loop = arguments.loop;
  options.utime_origin = arguments.utime_origin;
  CheckSource(options);
  return options;
}

GrabberOptions MakeGrabberOptions(const CaptureOptions& options) {
  GrabberOptions grabber;
  grabber.speed = options.speed;
  grabber.every_frame = options.lockstep;
  grabber.loop = options.loop;
  grabber.utime_origin = options.utime_origin;
  return grabber;
}

class CaptureService {
 public:
  CaptureService(const NodeOptions& node, const CaptureOptions& options, bool wait_for_answers)
      : options_(options),
        wait_for_answers_(wait_for_answers),
        budget_(options.jpeg_quality),
        node_(node),
        grabber_([options] { return OpenSource(options); }, MakeGrabberOptions(options), [this] { node_.Wake(); }) {
    if (wait_for_answers_)
      node_.SubscribeNewest<part_poses_t>([this](const part_poses_t& m) {
        if (m.utime >= waiting_for_) waiting_for_ = -1;
      });
  }

  void Run() {
    node_.Run([this] { Step(); });
    if (const std::exception_ptr failure = grabber_.failure()) try {
        std::rethrow_exception(failure);
      } catch (const std::exception& e) {
        throw DeviceError(options_.source + ": " + e.what());
      }
  }

 private:
  void Step() {
    EndIfTheDriverHangs();
    if (waiting_for_ >= 0 && SteadyTime() < answer_due_) return;
    const std::optional<Frame> frame = grabber_.Take();
    CountFrames();
    if (frame) Answer(*frame);
    ReportState();
    if (!frame && grabber_.ended()) node_.Stop();
  }

  /// Nothing in this process can end a thread that hangs in a driver: the process goes, and is started again.
  void EndIfTheDriverHangs() const {
    const bool recording = options_.source.rfind("openni2:", 0) != 0;
    if (recording || grabber_.ended() || SteadyTime() - grabber_.last_sign() < kHangs) return;
    spdlog::critical("{}: the camera's driver hangs", options_.source);
    std::_Exit(3);
  }

  void CountFrames() {
    if (const int64_t grabbed = grabber_.grabbed(); grabbed > node_.statistics().received)
      node_.Received(grabbed - node_.statistics().received);
    const int64_t replaced = grabber_.replaced();
    node_.Dropped(replaced - replaced_seen_);
    replaced_seen_ = replaced;
  }

  void Answer(Frame frame) {
    if (options_.lockstep) frame.received_utime = 0;
    bool sent = false;
    try {
      sent = Publish(frame);
    } catch (const std::invalid_argument& e) {
      spdlog::warn("frame {} is no good: {}", frame.sequence, e.what());
    }
    if (!sent) return node_.Dropped();
    node_.Answered(frame.received_utime);
    if (!wait_for_answers_) return;
    waiting_for_ = frame.utime;
    answer_due_ = SteadyTime() + kAnswerTimeout;
  }

  bool Publish(const Frame& frame) {
    const depth_image_t depth = ToDepthMessage(frame, DepthEncoding::kZstd);
    if (frame.colour.empty()) return node_.Publish(depth);
    color_image_t colour;
    do {
      colour = ToColourMessage(frame, ColourEncoding::kJpeg, budget_.quality());
    } while (!budget_.Accept(colour.data_size, depth.data_size));
    return node_.Publish(std::move(colour)) && node_.Publish(depth);
  }

  void ReportState() {
    const bool lowered = budget_.lowered_frames() > lowered_seen_;
    lowered_seen_ = budget_.lowered_frames();
    if (lowered) show_lowered_until_ = SteadyTime() + 10'000'000;
    std::string complaint = grabber_.complaint();
    if (!complaint.empty()) return node_.SetState(service_health_t::DEGRADED, options_.source + ": " + complaint);
    if (node_.statistics().answered == 0) return;
    if (SteadyTime() < show_lowered_until_)
      node_.SetState(service_health_t::OK, "JPEG quality lowered to keep frames under 180 kB");
    else
      node_.SetState(service_health_t::OK, "");
  }

  CaptureOptions options_;
  bool wait_for_answers_;
  ImageBudget budget_;
  Node node_;
  int64_t waiting_for_ = -1, answer_due_ = 0;
  int64_t lowered_seen_ = 0, show_lowered_until_ = 0;
  int64_t replaced_seen_ = 0;
  FrameGrabber grabber_;
};

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  coach::Arguments arguments;
  const auto add_options = [&](CLI::App& app) {
    app.add_option("--source", arguments.source, "openni2:, openni2:DEVICE, oni:FILE or scene:FOLDER");
    app.add_option("--fps", arguments.fps, "frames a second of a scene folder, or asked of a camera")
        ->check(CLI::PositiveNumber);
    app.add_option("--speed", arguments.speed, "of a recording, times real time")->check(CLI::PositiveNumber);
    app.add_flag("--lockstep", arguments.lockstep,
                 "every frame of a recording, each when PART_POSES has answered the one before");
    app.add_flag("--loop", arguments.loop, "begin a recording again when it is over");
    app.add_option("--utime-origin", arguments.utime_origin, "utime (us) of a recording's first frame")
        ->check(CLI::NonNegativeNumber);
  };
  return coach::ServiceMain(argc, argv, "capture", "Frames from a camera or a recording onto the bus.", add_options,
                            [&](coach::ServiceContext& context) {
                              const coach::CaptureOptions options = coach::MakeOptions(context.station, arguments);
                              const bool to_recording = !context.node.output_url.empty();
                              if (to_recording) context.node.url = "memq://";
                              context.node.lockstep = options.lockstep;
                              context.node.expects_frames = true;
                              coach::CaptureService(context.node, options, options.lockstep && !to_recording).Run();
                            });
}
