// coach-detector: regions of the task's colours in every frame.
#include <CLI/CLI.hpp>

#include "common/assembly/task_file.h"
#include "common/bus/frame_joiner.h"
#include "common/bus/image_messages.h"
#include "common/bus/messages.h"
#include "common/bus/service_main.h"
#include "common/bus/task_follower.h"
#include "services/detector/detector_options.h"

namespace coach {
namespace {

class DetectorService {
 public:
  DetectorService(const NodeOptions& node, const Station& station, const Task& task, const HsvDetectorOptions& options)
      : detector_(std::make_unique<HsvDetector>(task, options)),
        node_(node),
        follower_(node_, station, task.sha256,
                  [this, options](const Task& other) { detector_ = std::make_unique<HsvDetector>(other, options); }) {
    // All of them: the joiner keeps the newest frame that has both images.
    node_.Subscribe<color_image_t>([this](const color_image_t& m) {
      node_.Received();
      frames_.Add(m);
    });
    node_.Subscribe<depth_image_t>([this](const depth_image_t& m) { frames_.Add(m); });
  }

  void Run() {
    node_.Run([this] { Step(); });
  }

 private:
  void Step() {
    const auto joined = frames_.Next();
    node_.Dropped(frames_.dropped() - dropped_seen_);
    dropped_seen_ = frames_.dropped();
    if (!joined) return;
    try {
      node_.Publish(ToMessage(Detect(joined->primary, std::get<0>(joined->companions))));
    } catch (...) {
      node_.Dropped();
      throw;
    }
    node_.Answered(joined->primary.received_utime);
  }

  Detections Detect(const color_image_t& colour, const std::unique_ptr<depth_image_t>& depth) {
    const Frame frame = FromMessage(colour);
    const Frame depth_frame = depth ? FromMessage(*depth) : Frame();
    Detections detections = detector_->Detect(frame.colour, depth_frame.depth, depth_frame.metres_per_unit);
    detections.utime = frame.utime;
    detections.received_utime = frame.received_utime;
    detections.sequence = frame.sequence;
    return detections;
  }

  std::unique_ptr<HsvDetector> detector_;
  FrameJoiner<color_image_t, depth_image_t> frames_;
  int64_t dropped_seen_ = 0;
  Node node_;
  TaskFollower follower_;
};

}  // namespace
}  // namespace coach

int main(int argc, char** argv) {
  return coach::ServiceMain(
      argc, argv, "detector", "Finds regions of the task's colours in every frame.", nullptr,
      [](coach::ServiceContext& context) {
        const coach::Station& station = context.station;
        const coach::HsvDetectorOptions options = coach::ReadDetectorOptions(station.Section("detector"));
        if (station.task.empty()) throw coach::ConfigurationError("no task: give task in the station file, or --task");
        context.node.expects_frames = true;
        coach::DetectorService(context.node, station, coach::LoadTask(station.task), options).Run();
      });
}
