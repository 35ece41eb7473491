#include "services/robot_bridge/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace coach {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// The check value of NAO V5/V6's published chain, computed by hand from its link table.
TEST(KinematicsTest, CheckValueOfTheRightArmAndTheHead) {
  const Vector3 target(0.35, -0.10, -0.05);
  const Aim arm = PointAt(Arm::kRight, RestAngles(), target);
  EXPECT_NEAR(At(arm.angles, Joint::kRShoulderPitch), 0.4049, 1e-3);
  EXPECT_NEAR(At(arm.angles, Joint::kRShoulderRoll), 0.0090, 1e-3);
  EXPECT_NEAR(At(arm.angles, Joint::kRElbowRoll), 0.0349, 1e-9);
  EXPECT_EQ(At(arm.angles, Joint::kRElbowYaw), 0);
  EXPECT_FALSE(arm.clamped);
  const Aim gaze = LookAt(RestAngles(), target);
  EXPECT_NEAR(At(gaze.angles, Joint::kHeadYaw), -0.2783, 1e-3);
  EXPECT_NEAR(At(gaze.angles, Joint::kHeadPitch), 0.4618, 1e-3);
  EXPECT_TRUE(gaze.clamped);
  EXPECT_NEAR(gaze.residual, 0.5915 - 0.4618, 0.02);
}

// Straight arms forward, from the link lengths alone: 105 + 55.95 + 57.75 mm.
TEST(KinematicsTest, StretchedArmHasTheLengthOfItsLinks) {
  JointAngles angles{};
  const ArmPoints left = ForwardKinematics(Arm::kLeft, angles);
  EXPECT_LT((left.p_R_shoulder - Vector3(0, 0.098, 0.1)).norm(), 1e-12);
  EXPECT_LT((left.p_R_elbow - Vector3(0.105, 0.113, 0.1)).norm(), 1e-12);
  EXPECT_LT((left.p_R_wrist - Vector3(0.16095, 0.113, 0.1)).norm(), 1e-12);
  EXPECT_LT((left.p_R_hand - Vector3(0.2187, 0.113, 0.08769)).norm(), 1e-12);
  At(angles, Joint::kRShoulderPitch) = std::numbers::pi / 2;  // straight down
  const ArmPoints right = ForwardKinematics(Arm::kRight, angles);
  EXPECT_LT((right.p_R_elbow - Vector3(0, -0.113, -0.005)).norm(), 1e-12);
}

TEST(KinematicsTest, ThousandTargetsOnTheTable) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> ahead(0.25, 0.8), side(-0.4, 0.4), height(-0.12, 0.0);
  int exact_arm = 0, exact_gaze = 0;
  double worst_arm = 0, worst_gaze = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3 target(ahead(random), side(random), height(random));
    const Arm arm = target.y() > 0 ? Arm::kLeft : Arm::kRight;
    const Aim aim = PointAt(arm, RestAngles(), target);
    EXPECT_TRUE(WithinLimits(aim.angles));
    if (!aim.clamped) {
      ++exact_arm;
      worst_arm = std::max(worst_arm, aim.residual);
    } else {
      EXPECT_GT(aim.residual, 1e-6);
    }
    const Aim gaze = LookAt(RestAngles(), target);
    EXPECT_TRUE(WithinLimits(gaze.angles));
    if (!gaze.clamped) {
      ++exact_gaze;
      worst_gaze = std::max(worst_gaze, gaze.residual);
    } else {
      EXPECT_GT(gaze.residual, 1e-6);
    }
  }
  RecordProperty("arm_within_limits", exact_arm);
  RecordProperty("gaze_within_limits", exact_gaze);
  std::printf("arm: %d of 1000 within limits, worst residual %.2g deg; gaze: %d, %.2g deg\n", exact_arm,
              worst_arm / kDegree, exact_gaze, worst_gaze / kDegree);
  EXPECT_GT(exact_arm, 950);
  EXPECT_LT(worst_arm, 0.1 * kDegree);
  EXPECT_GT(exact_gaze, 200);
  EXPECT_LT(worst_gaze, 0.1 * kDegree);
}

TEST(KinematicsTest, AimingTheShoulderAloneWouldMissByDegrees) {
  const Vector3 target(0.35, -0.10, -0.05);
  JointAngles naive = PointAt(Arm::kRight, RestAngles(), target).angles;
  At(naive, Joint::kRShoulderRoll) = std::atan2(-0.002, std::hypot(0.35, 0.15));
  EXPECT_GT(PointingError(Arm::kRight, naive, target), 1.0 * kDegree);
}

TEST(KinematicsTest, TargetBehindOrAtTheShoulderIsClampedAndFinite) {
  for (const Vector3& target :
       {Vector3(-0.4, 0.1, 0), Vector3(0, 0.098, 0.1), Vector3(0, 0, 0.1265), Vector3(0, 0, 5)}) {
    for (const Arm arm : {Arm::kLeft, Arm::kRight}) {
      const Aim aim = PointAt(arm, RestAngles(), target);
      for (const double angle : aim.angles) EXPECT_TRUE(std::isfinite(angle));
      EXPECT_TRUE(WithinLimits(aim.angles));
    }
    EXPECT_TRUE(WithinLimits(LookAt(RestAngles(), target).angles));
  }
  EXPECT_TRUE(LookAt(RestAngles(), Vector3(-0.4, 0.05, 0)).clamped);
}

TEST(KinematicsTest, HandPoseTurnsWithTheWristAboutTheForearm) {
  JointAngles angles = PointAt(Arm::kLeft, RestAngles(), Vector3(0.4, 0.1, 0)).angles;
  const Pose before = HandPose(Arm::kLeft, angles);
  At(angles, Joint::kLWristYaw) = 0.7;
  const Pose after = HandPose(Arm::kLeft, angles);
  EXPECT_LT((before.linear().col(0) - after.linear().col(0)).norm(), 1e-12);
  EXPECT_NEAR(RotationAngle(before.linear().transpose() * after.linear()), 0.7, 1e-9);
}

}  // namespace
}  // namespace coach
