#include "services/robot_bridge/joints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace coach {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(JointsTest, HeadPitchRangeAtAndBetweenTheTablesRows) {
  EXPECT_NEAR(HeadPitchRange(0).high, 29.51 * kDegree, 1e-12);
  EXPECT_NEAR(HeadPitchRange(-62.45 * kDegree).low, -24.64 * kDegree, 1e-12);
  EXPECT_NEAR(HeadPitchRange(0.5 * (27.85 + 43.32) * kDegree).high, 0.5 * (24.18 + 21.2) * kDegree, 1e-12);
  EXPECT_NEAR(HeadPitchRange(3).high, 18.91 * kDegree, 1e-12);
}

TEST(JointsTest, ClampingIsIdempotentAndKeepsAllowedAngles) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-4, 4);
  for (int i = 0; i < 200; ++i) {
    JointAngles angles;
    for (double& angle : angles) angle = any(random);
    const JointAngles clamped = ClampToLimits(angles);
    EXPECT_TRUE(WithinLimits(clamped));
    EXPECT_EQ(ClampToLimits(clamped), clamped);
  }
  EXPECT_TRUE(WithinLimits(RestAngles()));
  JointAngles bad = RestAngles();
  bad[3] = std::nan("");
  EXPECT_FALSE(WithinLimits(bad));
}

TEST(JointsTest, SmoothPathKeepsTheSpeedLimitAndReachesItsEnd) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-2, 2);
  for (int i = 0; i < 50; ++i) {
    std::vector<JointAngles> way(3);
    for (JointAngles& angles : way) {
      for (double& angle : angles) angle = any(random);
      angles = ClampToLimits(angles);
    }
    const JointPath path = SmoothPath(way, 0.3);
    EXPECT_EQ(path.points.back().angles, way.back());
    for (size_t p = 1; p < path.points.size(); ++p) {
      const double dt = path.points[p].time - path.points[p - 1].time;
      EXPECT_LE(dt, 0.0501);
      for (size_t j = 2; j < kNumJoints; ++j) {  // the head's pitch may be clamped between
        const double speed = std::abs(path.points[p].angles[j] - path.points[p - 1].angles[j]) / dt;
        EXPECT_LE(speed, 0.3 * LimitOf(static_cast<int>(j)).speed * 1.001);
      }
    }
  }
}

TEST(JointsTest, PathIsHeldBeforeItsStartAndAfterItsEnd) {
  JointAngles goal = RestAngles();
  At(goal, Joint::kHeadYaw) = 1;
  const JointPath path = SmoothPath({RestAngles(), goal}, 0.3);
  EXPECT_EQ(path.At(-1), RestAngles());
  EXPECT_EQ(path.At(100), goal);
  EXPECT_NEAR(At(path.At(path.duration() / 2), Joint::kHeadYaw), 0.5, 0.02);
  EXPECT_TRUE(path.moves[0]);
  EXPECT_FALSE(path.moves[5]);
  EXPECT_EQ(SmoothPath({goal, goal}, 0.3).duration(), 0);
}

}  // namespace
}  // namespace coach
