#include "tools/calibrate_robot/calibration_run.h"

#include <algorithm>

namespace coach {
namespace {

constexpr double kSpeed = 0.12;         // share of the joints' greatest speed
constexpr int64_t kSettle = 1200000;    // us, after the motion: the arm swings, the tracker catches up
constexpr int64_t kPatience = 4000000;  // us, to see the part
constexpr size_t kFrames = 15;          // frames that make a sample
constexpr double kConfidence = 0.3;

Vector3 MedianOf(std::vector<Vector3> points) {
  Vector3 median;
  const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
  for (int axis = 0; axis < 3; ++axis) {
    std::nth_element(points.begin(), middle, points.end(),
                     [axis](const Vector3& a, const Vector3& b) { return a[axis] < b[axis]; });
    median[axis] = (*middle)[axis];
  }
  return median;
}

}  // namespace

CalibrationRun::CalibrationRun(BackEnd& robot, Arm arm, int part, std::function<void(const std::string&)> say)
    : robot_(robot), arm_(arm), part_(part), say_(std::move(say)), poses_(CalibrationPoses(arm)) {}

void CalibrationRun::See(const PartPoses& poses) {
  if (!looking_ || part_ >= static_cast<int>(poses.parts.size())) return;
  const PartEstimate& part = poses.parts[static_cast<size_t>(part_)];
  if (part.status == PartStatus::kTracked && part.confidence >= kConfidence) seen_.push_back(part.X_TP.translation());
}

void CalibrationRun::MoveTo(const JointAngles& goal, int64_t now) {
  const JointPath path = SmoothPath({robot_.MeasuredAngles().value_or(RestAngles()), goal}, kSpeed);
  robot_.Move(path);
  still_at_ = now + static_cast<int64_t>(path.duration() * 1e6) + kSettle;
  seen_.clear();
}

void CalibrationRun::TakeSample() {
  const auto angles = robot_.MeasuredAngles();
  const std::string name = "pose " + std::to_string(next_) + " of " + std::to_string(poses_.size());
  if (seen_.size() < kFrames || !angles) {
    say_(name + ": the part was not seen well (" + std::to_string(seen_.size()) + " frames); left out");
    return;
  }
  samples_.push_back({arm_, *angles, MedianOf(seen_)});
  say_(name + ": seen");
}

void CalibrationRun::Step(int64_t now) {
  if (finished() || !robot_.State().connected || now < still_at_) return;
  if (next_ > 0 && !looking_) {
    looking_ = true;
    seen_.clear();
  }
  if (looking_) {
    if (seen_.size() < kFrames && now < still_at_ + kPatience) return;
    TakeSample();
    looking_ = false;
  }
  MoveTo(next_ < poses_.size() ? poses_[next_] : RestAngles(), now);
  ++next_;
}

}  // namespace coach
