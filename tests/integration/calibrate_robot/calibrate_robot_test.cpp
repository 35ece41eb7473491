// coach-calibrate-robot from end to end: a robot that speaks qi takes the poses, a tracker sees the part in its hand
// with noise, and the station file knows in the end where the robot sits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <numbers>
#include <random>

#include "common/bus/bus.h"
#include "common/bus/messages.h"
#include "common/configuration/station.h"
#include "fake_qi_server.h"
#include "process.h"
#include "services/robot_bridge/kinematics.h"
#include "services/robot_bridge/robot_options.h"

namespace coach {
namespace {

using testing::HasSubstr;

/// The tracker: the part is where the arm of the fake robot holds it, seen with noise.
class DrawnTracker {
 public:
  DrawnTracker(const FakeQiServer& robot, const Pose& X_TR, const Vector3& p_H)
      : robot_(robot), X_TR_(X_TR), p_H_(p_H), bus_("udpm://239.255.76.67:7667?ttl=0", "CAL") {}

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

TEST(CalibrateRobot, WritesWhereTheRobotSitsAndKeepsTheOldFile) {
  const auto folder = std::filesystem::temp_directory_path() / ("coach_calibrate_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const auto file = folder / "station.yaml";
  const FakeQiServer robot;
  std::ofstream(file)
      << "station: CAL   # kept\ntask: " << COACH_SOURCE_DIR
      << "/deploy/tasks/rectangle_long_medium.yaml\nrobot:\n  back_end: nao\n  position: [0, 0, 0]\n  nao: {url: \""
      << robot.url() << "\"}\n";
  const Pose X_TR = MakePose(ExpRotation(Vector3(0.01, 0.03, -1.7)), Vector3(0.06, 0.48, 0.05));
  DrawnTracker tracker(robot, X_TR, Vector3(0.02, -0.01, 0.015));
  Process program({Program("coach-calibrate-robot"), "--config", file.string(), "--part", "long_1", "--yes"});
  EXPECT_TRUE(Until(
      120, [&] { usleep(20000), tracker.Send(); }, [&] { return !program.running(); }));
  ASSERT_EQ(program.Wait(1), 0) << program.output();
  EXPECT_THAT(program.output(), HasSubstr("from 8 poses"));
  EXPECT_TRUE(robot.Violations().empty());
  const Station station = ReadStation(file);
  const Pose found = ReadRobotOptions(station.Section("robot")).conductor.X_TR;
  EXPECT_LT((found.translation() - X_TR.translation()).norm(), 0.004);
  const double turned = Eigen::AngleAxisd(found.linear().transpose() * X_TR.linear()).angle();
  EXPECT_LT(turned * 180 / std::numbers::pi, 1.0);
  EXPECT_THAT(station.text, HasSubstr("station: CAL   # kept\n"));
  EXPECT_TRUE(std::filesystem::exists(folder / "station.yaml.old"));
  std::filesystem::remove_all(folder);
}

TEST(CalibrateRobot, APartThatIsNotSeenLeavesTheFileAlone) {
  const auto folder = std::filesystem::temp_directory_path() / ("coach_calibrate_bad_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  const auto file = folder / "station.yaml";
  std::ofstream(file) << "station: CAL\ntask: " << COACH_SOURCE_DIR << "/deploy/tasks/square.yaml\n";
  Process unknown({Program("coach-calibrate-robot"), "--config", file.string(), "--part", "gold_1", "--yes"});
  EXPECT_NE(unknown.Wait(20), 0);
  EXPECT_THAT(unknown.output(), HasSubstr("expected one of"));
  EXPECT_FALSE(std::filesystem::exists(folder / "station.yaml.old"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace coach
