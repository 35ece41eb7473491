// The result files: poses (BOP's results csv), states, events, timings. See docs/formats.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "common/assembly/assembly_state.h"
#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"

namespace coach {

/// `scene_id,im_id,obj_id,score,R,t,time`: one row per part and frame, in the order of Task::parts. R and t (mm) are
/// the pose X_CP of the part in the camera; time is -1, so that files of two runs can be compared. A part that is
/// absent or lost has score 0 and repeats its last pose in the table frame (the identity rotation at 0 0 0 if it was
/// never seen).
class PosesCsv {
 public:
  /// @throws std::runtime_error naming the file if it can't be written; so do the other writers below.
  PosesCsv(const std::filesystem::path& file, const Task& task, int scene_id);
  /// `poses` has one part per part of the task.
  void Write(int im_id, const PartPoses& poses);

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  std::vector<int> object_ids_;
  std::vector<Pose> last_X_TP_;
  std::vector<bool> seen_;
  int scene_id_;
};

/// `im_id,instance,status,visible_fraction,confidence,ambiguous_with,ambiguous_probability,c_0,...,c_20`: the
/// covariance's upper triangle in the camera frame, m and rad; ambiguous_with is an instance's name or empty.
class StatesCsv {
 public:
  StatesCsv(const std::filesystem::path& file, const Task& task);
  void Write(int im_id, const PartPoses& poses);

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  std::vector<std::string> instances_;
};

/// `time,connection,type,part_a,part_b,probability,decided`: one row per event of kind connect, wrong or disconnect;
/// other kinds are passed over. time (the estimated moment of change) and decided (when it was announced) are seconds
/// from first_utime; parts are instance names.
class EventsCsv {
 public:
  EventsCsv(const std::filesystem::path& file, const Task& task, int64_t first_utime);
  void Write(const GuidanceEvent& event);

 private:
  std::filesystem::path file_;
  std::ofstream out_;
  std::vector<std::string> instances_;
  int64_t first_utime_;
};

/// `im_id,stage,seconds`.
class TimingsCsv {
 public:
  explicit TimingsCsv(const std::filesystem::path& file);
  void Write(int im_id, const std::string& stage, double seconds);

 private:
  std::filesystem::path file_;
  std::ofstream out_;
};

}  // namespace coach
