#include "tools/calibrate_robot/calibration_run.h"

#include <algorithm>

namespace coach {
namespace {

constexpr double kSpeed = 0.12;             // share of the joints' greatest speed
constexpr int64_t kSettle = 1200000;        // us, after the motion: the arm swings, the tracker catches up
constexpr int64_t kPatience = 4000000;      // us, to see the part
constexpr int64_t kLongestAway = 60000000;  // us, without the robot
constexpr size_t kFrames = 15;              // frames that make a sample
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

CalibrationRun::CalibrationRun(BackEnd& robot, Arm arm, int part)
    : robot_(robot), arm_(arm), part_(part), poses_(CalibrationPoses(arm)) {}

void CalibrationRun::See(const PartPoses& poses) {
  if (!looking_ || part_ < 0 || part_ >= static_cast<int>(poses.parts.size())) return;
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
  const bool used = seen_.size() >= kFrames && angles;
  reports_.push_back({seen_.size(), used});
  if (used) samples_.push_back({arm_, *angles, MedianOf(seen_)});
}

void CalibrationRun::Fail(const std::string& problem) {
  state_ = State::kFailed;
  problem_ = problem;
}

void CalibrationRun::Finish() {
  result_ = CalibrateRobot(samples_);
  if (!result_.success) return Fail(result_.problem);
  state_ = State::kDone;
  problem_.clear();
}

void CalibrationRun::Stop() {
  if (over()) return;
  robot_.Freeze();
  Fail("stopped");
}

void CalibrationRun::Step(int64_t now) {
  robot_.Poll(now);
  if (over()) return;
  const BackEndState robot = robot_.State();
  if (!robot.connected) {
    if (away_since_ == 0) away_since_ = now;
    problem_ = robot.detail;
    if (now - away_since_ > kLongestAway) Fail("no robot: " + robot.detail);
    return;
  }
  away_since_ = 0;
  state_ = State::kMoving;
  if (now < still_at_) return;
  if (next_ > poses_.size()) return Finish();
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
