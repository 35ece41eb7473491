// The second stage: from depth and regions of colour to the pose of every part.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>

#include "common/assembly/detections.h"
#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"
#include "common/geometry/camera.h"

namespace coach {

/// One moment's input. What is missing is empty or null: the filter works on what is there.
struct FilterInput {
  int64_t utime = 0;           ///< us; must grow from step to step
  int64_t received_utime = 0;  ///< us, carried to the output
  int64_t sequence = 0;        ///< carried to the output
  CameraModel camera;
  cv::Mat depth;  ///< CV_16UC1 or empty
  double metres_per_unit = 0.001;
  cv::Mat colour;                            ///< CV_8UC3 (blue green red) or empty
  const Detections* detections = nullptr;    ///< of the same utime, or null
  const ConnectionBelief* belief = nullptr;  ///< newest from the reasoner, or null; the filter checks its age
};

/// A tracker of all parts of a task. Deterministic: the same inputs and seed give the same outputs.
class PoseFilter {
 public:
  virtual ~PoseFilter() = default;
  /// Never throws for bad data: what can't be used is ignored and shows in the status of the parts. The result is valid
  /// until the next call.
  virtual const PartPoses& Step(const FilterInput& input) = 0;
  /// Forgets every pose; the next step starts from nothing.
  virtual void Reset() = 0;
  /// Poses known from elsewhere (a state file, or ground truth where the option's name says so), as hypotheses that
  /// must win on the image. Index = part; X_CP in the camera frame of the next step.
  virtual void Suggest(const std::vector<Pose>& X_CP) = 0;
};

}  // namespace coach
