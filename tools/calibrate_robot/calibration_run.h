// One calibration: the arm goes from pose to pose and rests in each until the part in its hand has been seen well; then
// the seat is computed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/assembly/part_poses.h"
#include "services/robot_bridge/back_end.h"
#include "services/robot_bridge/robot_calibration.h"

namespace coach {

/// What came of one pose of the arm.
struct PoseReport {
  size_t frames = 0;  ///< in which the part was seen while the arm rested
  bool used = false;  ///< enough of them
};

class CalibrationRun {
 public:
  enum class State { kConnecting, kMoving, kDone, kFailed };

  /// @param part index of the part in the hand
  CalibrationRun(BackEnd& robot, Arm arm, int part);

  /// What the tracker sees.
  void See(const PartPoses& poses);
  /// Call at 20 Hz or more; polls the robot. @param now us, monotonic
  void Step(int64_t now);
  /// The arm stays where it is; ends as kFailed.
  void Stop();

  State state() const { return state_; }
  bool over() const { return state_ == State::kDone || state_ == State::kFailed; }
  /// kConnecting: why the robot is not there yet. kFailed: why there is no result.
  const std::string& problem() const { return problem_; }
  size_t poses() const { return poses_.size(); }
  /// Of the poses so far, in order.
  const std::vector<PoseReport>& reports() const { return reports_; }
  const std::vector<CalibrationSample>& samples() const { return samples_; }
  /// Of kDone.
  const CalibrationResult& result() const { return result_; }

 private:
  void MoveTo(const JointAngles& goal, int64_t now);
  void TakeSample();
  void Fail(const std::string& problem);
  void Finish();

  BackEnd& robot_;
  Arm arm_;
  int part_;
  State state_ = State::kConnecting;
  std::string problem_;
  std::vector<JointAngles> poses_;
  size_t next_ = 0;         // pose that the arm goes to next; the one after the last: at rest
  bool looking_ = false;    // rests in a pose
  int64_t still_at_ = 0;    // us, when the arm has come to rest
  int64_t away_since_ = 0;  // us, when the robot was missed first; 0: it is there
  std::vector<Vector3> seen_;
  std::vector<PoseReport> reports_;
  std::vector<CalibrationSample> samples_;
  CalibrationResult result_;
};

/// Beyond this error to be expected at the table (m) a result is not worth keeping.
constexpr double kWorstCalibration = 0.02;

}  // namespace coach
