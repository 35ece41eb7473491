#include "services/assembly_reasoner/relative_pose_window.h"

#include <gtest/gtest.h>

#include <random>

namespace coach {
namespace {

RelativePoseSample Sample(int64_t utime, double x, double deviation = 0.001) {
  RelativePoseSample s;
  s.utime = utime;
  s.X_AB.translation().x() = x;
  s.covariance = Matrix6::Identity() * deviation * deviation;
  return s;
}

TEST(RelativePoseWindow, AveragesWhileNothingChanges) {
  RelativePoseWindow window;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.003);
  for (int i = 0; i < 60; ++i) window.Add(Sample(33333 * i, 0.1 + noise(random), 0.003));
  const auto estimate = window.Estimate(33333 * 59);
  ASSERT_TRUE(estimate);
  EXPECT_GT(estimate->constant_for, 1.2);
  EXPECT_NEAR(estimate->X_AB.translation().x(), 0.1, 0.002);
  EXPECT_LT(std::sqrt(estimate->covariance(0, 0)), 0.0016);
}

TEST(RelativePoseWindow, AJumpOfAFewFramesChangesNothing) {
  RelativePoseWindow window;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.0005);
  for (int i = 0; i < 40; ++i) window.Add(Sample(33333 * i, (i >= 33 && i < 36 ? 0.13 : 0.1) + noise(random)));
  EXPECT_NEAR(window.Estimate(33333 * 39)->X_AB.translation().x(), 0.1, 0.001);
}

TEST(RelativePoseWindow, AMoveShortensTheWindow) {
  RelativePoseWindow window;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.0005);
  for (int i = 0; i < 60; ++i) window.Add(Sample(33333 * i, (i < 50 ? 0.1 : 0.12) + noise(random)));
  const auto estimate = window.Estimate(33333 * 59);
  EXPECT_NEAR(estimate->X_AB.translation().x(), 0.12, 0.001);
  EXPECT_LT(estimate->constant_for, 0.5);
}

TEST(RelativePoseWindow, TheSpreadSeenOverridesACovarianceThatIsTooSmall) {
  RelativePoseWindow window;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 0.006);
  for (int i = 0; i < 5; ++i) window.Add(Sample(33333 * i, 0.1 + noise(random), 0.0002));
  EXPECT_GT(std::sqrt(window.Estimate(33333 * 4)->covariance(0, 0)), 0.001);
}

TEST(RelativePoseWindow, RefusesNonsense) {
  RelativePoseWindow window;
  window.Add(Sample(1000, 0.1));
  RelativePoseSample nan = Sample(2000, 0.2);
  nan.covariance(0, 0) = std::nan("");
  window.Add(nan);
  RelativePoseSample negative = Sample(2000, 0.2);
  negative.covariance(3, 3) = -1;
  window.Add(negative);
  window.Add(Sample(500, 0.3));   // goes back in time
  window.Add(Sample(3000, 0.1));  // a repeated value
  EXPECT_EQ(window.samples().size(), 1u);
  EXPECT_FALSE(RelativePoseWindow().Estimate(0));
  EXPECT_FALSE(window.Estimate(10000000));  // nothing recent
}

TEST(RelativePoseWindow, ReversedTwiceIsTheSame) {
  RelativePoseWindow window;
  RelativePoseSample s = Sample(1000, 0.1);
  s.X_AB.linear() = ExpRotation({0.3, -0.2, 0.9});
  s.covariance.diagonal() << 1, 2, 3, 4, 5, 6;
  window.Add(s);
  window.Reverse();
  EXPECT_TRUE((window.samples()[0].X_AB * s.X_AB).isApprox(Pose::Identity(), 1e-9));
  window.Reverse();
  EXPECT_LT((window.samples()[0].covariance - s.covariance).norm(), 1e-9);
}

}  // namespace
}  // namespace coach
