// The seat of a NAO, measured from the page: the robot holds a part, moves its arm, and the tracker sees the part.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "common/assembly/part_poses.h"
#include "services/robot_bridge/nao_robot.h"
#include "tools/calibrate_robot/calibration_run.h"

namespace coach {

/// Thread safe. JSON in, JSON out; the other side is page/setup_calibration.js. It has a connection of its own to the
/// robot, so no lesson may run meanwhile: the robot bridge is idle then and leaves the arms alone.
class SeatCalibration {
 public:
  using Connect = std::function<std::unique_ptr<BackEnd>(const NaoOptions&)>;
  explicit SeatCalibration(Connect connect) : connect_(std::move(connect)) {}

  /// {part: index, arm: "left" or "right", url}: begins. @param options of the robot, but for the url. -> Status()
  /// @throws std::invalid_argument busy, lesson, or what is wrong with the request
  std::string Start(const std::string& request, NaoOptions options, bool lesson_runs);

  /// {state: none, connecting, moving, done or failed; problem, poses, reports: [{frames, used}] of the poses so far;
  /// done: residual_mm, expected_mm, good, position, roll_pitch_yaw}
  std::string Status() const;

  void OnPoses(const PartPoses& poses);
  /// Call at 20 Hz or more. @param now us, monotonic
  void Step(int64_t now);
  /// The arm stays where it is.
  void Stop();

 private:
  const Connect connect_;
  mutable std::mutex mutex_;
  std::unique_ptr<BackEnd> robot_;     // while it is needed
  std::optional<CalibrationRun> run_;  // the last one, to be asked about
  int64_t over_since_ = 0;             // us
};

}  // namespace coach
