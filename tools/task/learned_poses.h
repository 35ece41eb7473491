// Learns a structure from the table: where parts are, from what the tracker saw of them while they lay still.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"
#include "tools/task/task_draft.h"

namespace coach {

struct LearningOptions {
  int64_t window_us = 4'000'000;  ///< data's time that is averaged
  int least_frames = 30;          ///< in it, of every part
  double still = 0.003;           ///< m; a part's positions must stay within it (90 % of them)
  double touching = 0.004;        ///< m; as DraftOptions::touching, with the tracker's error
};

/// Keeps the poses of the last seconds.
class LearnedPoses {
 public:
  explicit LearnedPoses(const LearningOptions& options = {}) : options_(options) {}
  void Add(const PartPoses& poses);

  struct Result {
    std::vector<Remark> problems;  ///< one a part that was not seen or not still; empty: learned
    std::vector<Pose> X_TP;        ///< mean poses, index = index in Task::parts
  };
  Result Mean(const Task& task) const;
  const LearningOptions& options() const { return options_; }

 private:
  LearningOptions options_;
  std::deque<PartPoses> recent_;
};

/// Mean position and rotation (the rotation nearest to the arithmetic mean); outliers, the farthest tenth from the
/// median position, are left out. @param poses not empty
Pose MeanPose(const std::vector<Pose>& poses);

/// The draft of a structure that was built on the table of the parts of `task`. All poses come from one mean for each
/// part, so that every ring of connections closes.
TaskDraft DraftOfTable(const std::string& name, const Task& task, const std::vector<Pose>& X_TP);

}  // namespace coach
