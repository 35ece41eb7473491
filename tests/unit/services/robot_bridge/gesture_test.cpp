#include "services/robot_bridge/gesture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

namespace coach {
namespace {

/// Half a metre from the table's middle, the front to -y.
Surroundings Seat() {
  return {MakePose(Eigen::AngleAxisd(-std::numbers::pi / 2, Vector3::UnitZ()).toRotationMatrix(), {0, 0.5, 0.08}), {}};
}

double LowestPoint(Arm arm, const JointPath& path, const Pose& X_TR) {
  double lowest = 1e9;
  for (const auto& point : path.points) {
    const ArmPoints arm_points = ForwardKinematics(arm, point.angles);
    for (const Vector3& p_R : {arm_points.p_R_elbow, arm_points.p_R_wrist, arm_points.p_R_hand}) {
      lowest = std::min(lowest, (X_TR * p_R).z());
    }
  }
  return lowest;
}

TEST(GestureTest, ArmOfTheTargetsSideWithHysteresis) {
  EXPECT_EQ(ChooseArm({0.4, 0.10, 0}, Arm::kRight, 0.03), Arm::kLeft);
  EXPECT_EQ(ChooseArm({0.4, -0.10, 0}, Arm::kLeft, 0.03), Arm::kRight);
  Arm arm = Arm::kLeft;
  int changes = 0;
  for (const double y : {0.05, 0.02, -0.02, 0.01, -0.029, 0.0, -0.031, -0.01, 0.02}) {
    const Arm next = ChooseArm({0.4, y, 0}, arm, 0.03);
    changes += next != arm;
    arm = next;
  }
  EXPECT_EQ(changes, 1);
}

TEST(GestureTest, EveryPathToTheTableStaysAboveItAndOutOfTheChildsSide) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> x(-0.35, 0.35), y(-0.2, 0.3);
  const GestureOptions options;
  int possible = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3 target(x(random), y(random), 0.03);
    const PointingPlan plan = PlanPointing(target, RestAngles(), Arm::kRight, Seat(), options);
    if (!plan.possible) continue;
    ++possible;
    EXPECT_GT(LowestPoint(plan.arm, plan.path, Seat().X_TR), options.table_margin - 0.006);
    for (const auto& point : plan.path.points) EXPECT_TRUE(WithinLimits(point.angles));
    if (!plan.clamped) {
      EXPECT_LT(plan.residual, 0.1 * 0.01745);
    }
  }
  EXPECT_GT(possible, 270);
}

TEST(GestureTest, TargetUnderTheHandIsPointedAtFromAboveAndSaidToBeClamped) {
  Surroundings low = Seat();
  low.X_TR.translation().z() = -0.05;
  const PointingPlan plan = PlanPointing({0, 0.32, 0.0}, RestAngles(), Arm::kRight, low, {});
  EXPECT_TRUE(plan.clamped);
  EXPECT_GT(plan.residual, 0.01);
}

TEST(GestureTest, TargetBehindTheRobotIsNotPointedAt) {
  const PointingPlan plan = PlanPointing({0, 0.9, 0}, RestAngles(), Arm::kRight, Seat(), {});
  EXPECT_FALSE(plan.possible);
  EXPECT_EQ(plan.obstacle, Obstacle::kNone);
  EXPECT_TRUE(plan.clamped);
}

TEST(GestureTest, HandNearTheArmBlocksTheWayAndOneFarOffDoesNot) {
  const GestureOptions options;
  const Vector3 target(0.1, 0.05, 0.02);
  const PointingPlan free = PlanPointing(target, RestAngles(), Arm::kRight, Seat(), options);
  ASSERT_TRUE(free.possible);
  Surroundings crowded = Seat();
  ForeignBlob hand;
  hand.centre = crowded.X_TR * ForwardKinematics(free.arm, free.path.points.back().angles).p_R_hand;
  hand.centre.x() += 0.18;
  hand.radius = 0.05;
  crowded.hands = {hand};
  const PointingPlan blocked = PlanPointing(target, RestAngles(), Arm::kRight, crowded, options);
  EXPECT_FALSE(blocked.possible);
  EXPECT_EQ(blocked.obstacle, Obstacle::kHand);
  crowded.hands[0].centre.x() += 0.15;
  EXPECT_TRUE(PlanPointing(target, RestAngles(), Arm::kRight, crowded, options).possible);
}

TEST(GestureTest, ArmKeepsItsDistanceFromTheChild) {
  GestureOptions options;
  options.child_distance = 0.15;
  const PointingPlan plan = PlanPointing({0, 0, 0}, RestAngles(), Arm::kRight, Seat(), options);
  EXPECT_FALSE(plan.possible);
  EXPECT_EQ(plan.obstacle, Obstacle::kChild);
}

TEST(GestureTest, ArmComesDownToItsRest) {
  const PointingPlan up = PlanPointing({0.1, 0.05, 0}, RestAngles(), Arm::kRight, Seat(), {});
  const PointingPlan down = PlanArmDown(up.arm, up.path.points.back().angles, Seat(), {});
  ASSERT_TRUE(down.possible);
  EXPECT_EQ(down.path.points.back().angles, RestAngles());
}

TEST(GestureTest, GazeTurnsOnlyTheHead) {
  const GazePlan plan = PlanGaze({0.2, 0.0, 0.03}, RestAngles(), Seat(), {});
  for (size_t j = 2; j < kNumJoints; ++j) EXPECT_FALSE(plan.path.moves[j]);
  EXPECT_TRUE(plan.path.moves[0]);
}

}  // namespace
}  // namespace coach
