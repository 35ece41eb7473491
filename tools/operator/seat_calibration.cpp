#include "tools/operator/seat_calibration.h"

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tools/operator/json_text.h"
#include "tools/operator/robot_seat.h"

namespace coach {
namespace {

using Json = nlohmann::json;

constexpr int64_t kLastWords = 1'000'000;  // us, for the robot to receive what it was told last

const char* NameOf(CalibrationRun::State state) {
  switch (state) {
    case CalibrationRun::State::kConnecting:
      return "connecting";
    case CalibrationRun::State::kMoving:
      return "moving";
    case CalibrationRun::State::kDone:
      return "done";
    case CalibrationRun::State::kFailed:
      return "failed";
  }
  return "failed";
}

}  // namespace

std::string SeatCalibration::Start(const std::string& request, NaoOptions options, bool lesson_runs) {
  const Json asked = Json::parse(request);
  const Arm arm = asked.at("arm") == "left" ? Arm::kLeft : Arm::kRight;
  const int part = asked.at("part").get<int>();
  options.url = asked.at("url").get<std::string>();
  if (lesson_runs) throw std::invalid_argument("lesson");
  {
    const std::lock_guard lock(mutex_);
    if (robot_) throw std::invalid_argument("busy");
    run_.reset();
    robot_ = connect_(options);
    run_.emplace(*robot_, arm, part);
    over_since_ = 0;
  }
  return Status();
}

std::string SeatCalibration::Status() const {
  const std::lock_guard lock(mutex_);
  if (!run_) return Dump({{"state", "none"}});
  Json json{{"state", NameOf(run_->state())},
            {"problem", run_->problem()},
            {"poses", run_->poses()},
            {"reports", Json::array()}};
  for (const PoseReport& report : run_->reports())
    json["reports"].push_back({{"frames", report.frames}, {"used", report.used}});
  if (run_->state() != CalibrationRun::State::kDone) return Dump(json);
  const CalibrationResult& result = run_->result();
  json.update(SeatJson(result.X_TR));
  json["residual_mm"] = Rounded(1e3 * result.residual, 10);
  json["expected_mm"] = Rounded(1e3 * result.left_out_residual, 10);
  json["good"] = result.left_out_residual <= kWorstCalibration;
  return Dump(json);
}

void SeatCalibration::OnPoses(const PartPoses& poses) {
  const std::lock_guard lock(mutex_);
  if (robot_) run_->See(poses);
}

void SeatCalibration::Step(int64_t now) {
  const std::lock_guard lock(mutex_);
  if (!robot_) return;
  run_->Step(now);
  if (!run_->over()) return;
  if (over_since_ == 0) over_since_ = now;
  if (now - over_since_ > kLastWords) robot_.reset();
}

void SeatCalibration::Stop() {
  const std::lock_guard lock(mutex_);
  if (robot_) run_->Stop();
}

}  // namespace coach
