// One calibration: the arm goes from pose to pose and rests in each until the part in its hand has been seen well.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/assembly/part_poses.h"
#include "services/robot_bridge/back_end.h"
#include "services/robot_bridge/robot_calibration.h"

namespace coach {

class CalibrationRun {
 public:
  /// @param part index of the part in the hand
  /// @param say receives one line a step, for the person who looks on
  CalibrationRun(BackEnd& robot, Arm arm, int part, std::function<void(const std::string&)> say);

  /// What the tracker sees.
  void See(const PartPoses& poses);
  /// Call at 20 Hz or more. @param now us, monotonic
  void Step(int64_t now);

  bool finished() const { return next_ > poses_.size(); }
  const std::vector<CalibrationSample>& samples() const { return samples_; }

 private:
  void MoveTo(const JointAngles& goal, int64_t now);
  void TakeSample();

  BackEnd& robot_;
  Arm arm_;
  int part_;
  std::function<void(const std::string&)> say_;
  std::vector<JointAngles> poses_;
  size_t next_ = 0;       // pose that the arm goes to next
  bool looking_ = false;  // rests in a pose
  int64_t still_at_ = 0;  // us, when the arm has come to rest
  std::vector<Vector3> seen_;
  std::vector<CalibrationSample> samples_;
};

}  // namespace coach
