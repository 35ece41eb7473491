// A tracker that is drawn, for calibrations of the fake NAO's seat.
#pragma once

#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "common/bus/bus.h"
#include "common/bus/messages.h"
#include "fake_qi_server.h"
#include "services/robot_bridge/kinematics.h"

namespace coach {

/// The tracker: the part is where the arm of the fake robot holds it, seen with noise.
class DrawnTracker {
 public:
  DrawnTracker(const FakeQiServer& robot, const std::string& station, const Pose& X_TR, const Vector3& p_H)
      : robot_(robot), X_TR_(X_TR), p_H_(p_H), bus_("udpm://239.255.76.67:7667?ttl=0", station) {}

  void Send() {
    Follow();
    PartPoses poses;
    poses.utime = SteadyNow();
    poses.table_found = true;
    poses.parts.resize(4);
    PartEstimate& part = poses.parts[0];
    part.status = PartStatus::kTracked;
    part.confidence = 0.9;
    part.visible_fraction = 0.8;
    const auto noise = [&] { return std::normal_distribution<double>(0, 0.0015)(random_); };
    part.X_TP.translation() = X_TR_ * (HandPose(Arm::kRight, angles_) * p_H_) + Vector3(noise(), noise(), noise());
    bus_.Publish(ToMessage(poses));
  }

 private:
  /// The arm is where the last motion ends (its way there is not looked at).
  void Follow() {
    const auto motion = robot_.LastArguments("ALMotion.angleInterpolation");
    if (motion.is_null() || motion == last_) return;
    last_ = motion;
    for (size_t i = 0; i < motion[0].size(); ++i) {
      for (int j = 0; j < kNumJoints; ++j) {
        if (motion[0][i] == LimitOf(j).name) angles_[static_cast<size_t>(j)] = motion[1][i].back();
      }
    }
  }

  const FakeQiServer& robot_;
  Pose X_TR_;
  Vector3 p_H_;
  Bus bus_;
  JointAngles angles_ = RestAngles();
  nlohmann::json last_;
  std::mt19937 random_{4};
};

}  // namespace coach
