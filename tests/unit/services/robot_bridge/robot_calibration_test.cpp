#include "services/robot_bridge/robot_calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "services/robot_bridge/kinematics.h"
#include "services/robot_bridge/robot_options.h"

namespace coach {
namespace {

using testing::HasSubstr;

Pose Seat(unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Vector3 turn(0.05 * normal(random), 0.05 * normal(random), -1.6 + 0.3 * normal(random));
  return MakePose(ExpRotation(turn), Vector3(0.1 * normal(random), 0.5, 0.1));
}

std::vector<CalibrationSample> Samples(const Pose& X_TR, const Vector3& p_H, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, noise);
  std::vector<CalibrationSample> samples;
  for (const JointAngles& angles : CalibrationPoses(Arm::kRight)) {
    const Vector3 error(normal(random), normal(random), normal(random));
    samples.push_back({Arm::kRight, angles, X_TR * (HandPose(Arm::kRight, angles) * p_H) + error});
  }
  return samples;
}

TEST(RobotCalibrationTest, ExactWithoutNoiseWhereverThePartIsHeld) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Pose X_TR = Seat(seed);
    const Vector3 p_H(0.01, -0.02, 0.015);
    const CalibrationResult result = CalibrateRobot(Samples(X_TR, p_H, 0, seed));
    ASSERT_TRUE(result.success) << result.problem;
    EXPECT_LT((result.X_TR.translation() - X_TR.translation()).norm(), 1e-4);
    EXPECT_LT(RotationAngle(result.X_TR.linear().transpose() * X_TR.linear()), 1e-3);
    EXPECT_LT((result.p_H - p_H).norm(), 1e-4);
    EXPECT_LT(result.residual, 1e-5);
  }
}

TEST(RobotCalibrationTest, TwoMillimetresOfNoiseMoveTheTableByMillimetres) {
  double worst = 0, mean_residual = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Pose X_TR = Seat(seed);
    const CalibrationResult result = CalibrateRobot(Samples(X_TR, Vector3(0.01, 0, 0.01), 0.002, seed));
    ASSERT_TRUE(result.success) << result.problem;
    const Vector3 target(0.45, 0.1, -0.08);  // a part on the table, robot frame
    worst = std::max(worst, (result.X_TR * target - X_TR * target).norm());
    mean_residual += result.residual / 40;
    EXPECT_GT(result.left_out_residual, result.residual);
  }
  std::printf("2 mm noise: worst error of a point on the table %.1f mm, mean residual %.2f mm\n", 1e3 * worst,
              1e3 * mean_residual);
  EXPECT_LT(worst, 0.025);
  EXPECT_LT(mean_residual, 0.004);
}

TEST(RobotCalibrationTest, SamplesThatCannotTellAreRefused) {
  auto samples = Samples(Seat(1), Vector3::Zero(), 0, 1);
  samples.resize(5);
  EXPECT_THAT(CalibrateRobot(samples).problem, HasSubstr("at least 6"));
  samples = Samples(Seat(1), Vector3::Zero(), 0, 1);
  for (CalibrationSample& sample : samples) sample.p_T.z() = 0.1;
  EXPECT_THAT(CalibrateRobot(samples).problem, HasSubstr("one plane"));
  samples[2].p_T.x() = std::nan("");
  EXPECT_THAT(CalibrateRobot(samples).problem, HasSubstr("finite"));
}

TEST(RobotCalibrationTest, PosesAreAllowedAndHighAboveTheTable) {
  for (const Arm arm : {Arm::kLeft, Arm::kRight}) {
    const auto poses = CalibrationPoses(arm);
    EXPECT_EQ(poses.size(), 8u);
    for (const JointAngles& angles : poses) {
      EXPECT_TRUE(WithinLimits(angles));
      EXPECT_GT((DefaultRobotPose() * ForwardKinematics(arm, angles).p_R_hand).z(), 0.08);
    }
  }
}

}  // namespace
}  // namespace coach
