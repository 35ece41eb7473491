// Feeds drawn pictures to the full filter.
#pragma once

#include <algorithm>

#include "services/pose_filter/full_filter.h"
#include "tests/support/drawn_observation.h"

namespace coach {

class DrawnSession {
 public:
  explicit DrawnSession(const Task& task, uint64_t seed = 1, const FullFilterOptions& options = {})
      : task_(task), filter_(task, options, seed) {}

  /// One frame, dt seconds later. Without a colour image there are no detections.
  PartPoses Step(const TestPicture& picture, double dt = 1.0 / 30) {
    utime_ += static_cast<int64_t>(dt * 1e6);
    Detections detections;
    FilterInput input;
    input.utime = utime_;
    input.camera = picture.camera;
    input.depth = picture.depth;
    input.colour = picture.colour;
    if (!picture.colour.empty()) {
      detections.utime = utime_;
      detections.width = picture.colour.cols;
      detections.height = picture.colour.rows;
      detections.num_classes = task_.NumColourClasses();
      detections.class_map = DrawnClassMap(task_, picture);
      input.detections = &detections;
    }
    return filter_.Step(input);
  }
  FullFilter& filter() { return filter_; }

 private:
  Task task_;
  FullFilter filter_;
  int64_t utime_ = 1000000;
};

inline Pose InCamera(const PartPoses& out, size_t part) { return out.X_TC.inverse() * out.parts[part].X_TP; }

/// Half turns about the three axes of a box.
inline SymmetryGroup BoxSymmetries() {
  return MakeSymmetryGroup({ExpRotation({std::numbers::pi, 0, 0}), ExpRotation({0, std::numbers::pi, 0})}, {});
}

/// Two equal Ls, blue, and a green brick that is symmetric.
inline Task TwoLsAndABrick() {
  Task task = TestTask({TestType("l", LMesh(), true, 2), TestType("brick", BoxMesh({0.09, 0.045, 0.03}), false, 1)});
  task.types[1].symmetries = BoxSymmetries();
  return task;
}

}  // namespace coach
