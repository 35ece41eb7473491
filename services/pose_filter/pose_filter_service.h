// The tracker on the bus.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

#include "common/bus/frame_joiner.h"
#include "common/bus/node.h"
#include "services/pose_filter/pose_filter.h"
#include "services/pose_filter/state_file.h"

namespace coach {

struct PoseFilterServiceOptions {
  std::filesystem::path state_file;  ///< written once a second; empty: nothing is kept
  int belief_frames = 5;             ///< CONNECTION_BELIEF of up to so many frames ago is handed to the filter
};

/// Steps when DEPTH_IMAGE, DETECTIONS and COLOR_IMAGE of one utime are there, or without what is missing as soon as the
/// next DEPTH_IMAGE is (FrameJoiner). Colour tells whether the camera stood still.
class PoseFilterService {
 public:
  using MakeFilter = std::function<std::unique_ptr<PoseFilter>(const Task&)>;

  PoseFilterService(const NodeOptions& node, const Task& task, MakeFilter make_filter,
                    const PoseFilterServiceOptions& options);
  /// Begins anew with another task.
  void SetTask(const Task& task);
  void Run();
  Node& node() { return node_; }

 private:
  void Step();
  void Answer(const depth_image_t& depth, const detections_t* detections, const color_image_t* colour);
  void BeginAgain();
  void KeepState(const PartPoses& poses);

  MakeFilter make_filter_;
  std::unique_ptr<PoseFilter> filter_;
  PoseFilterServiceOptions options_;
  std::string task_sha256_;
  FrameJoiner<depth_image_t, detections_t, color_image_t> frames_;
  int64_t dropped_seen_ = 0;
  std::optional<ConnectionBelief> belief_;
  std::vector<int64_t> recent_utimes_;  ///< of the last steps, for the age of the belief
  std::optional<FilterState> state_;    ///< of the last step
  int64_t last_state_ = 0;              ///< us, steady clock
  Node node_;
};

}  // namespace coach
