#include "common/geometry/symmetry.h"

#include <gtest/gtest.h>

#include <numbers>

namespace coach {
namespace {

const Matrix3 kHalfTurnY = ExpRotation({0, std::numbers::pi, 0});

TEST(SymmetryTest, ClosureOfQuarterTurnsHasFourElements) {
  EXPECT_EQ(MakeSymmetryGroup({ExpRotation({0, 0, std::numbers::pi / 2})}, {}).discrete.size(), 4u);
}

TEST(SymmetryTest, BrickRotatedByItsSymmetryHasNoError) {
  const SymmetryGroup group = MakeSymmetryGroup({kHalfTurnY}, {});
  EXPECT_EQ(group.discrete.size(), 2u);
  const Matrix3 R = ExpRotation({0.3, -0.5, 1});
  EXPECT_NEAR(RotationError(group, R, R * kHalfTurnY), 0, 1e-7);
  EXPECT_NEAR(RotationError(group, R, R * ExpRotation({0.1, 0, 0})), 0.1, 1e-7);
  EXPECT_NEAR(RotationError(MakeSymmetryGroup({}, {}), R, R * kHalfTurnY), std::numbers::pi, 1e-6);
}

TEST(SymmetryTest, FreeAxisLeavesTheAngleBetweenAxes) {
  const SymmetryGroup group = MakeSymmetryGroup({}, {{0, 0, 2}});
  const Matrix3 R = ExpRotation({0.3, -0.5, 1});
  for (double t : {0.1, 1.0, 3.0, -2.0})
    EXPECT_NEAR(RotationError(group, R, R * ExpRotation({0, 0, t}) * ExpRotation({0, 0.2, 0})), 0.2, 1e-6);
}

TEST(SymmetryTest, NearestEquivalentIsEquivalentAndNearest) {
  const SymmetryGroup group = MakeSymmetryGroup({kHalfTurnY}, {});
  const Pose reference = MakePose(ExpRotation({0.2, 0.1, 0}), {0, 0, 0});
  const Pose X = MakePose(ExpRotation({0.25, 0.1, 0.1}) * kHalfTurnY, {1, 2, 3});
  const Pose N = NearestEquivalent(group, X, reference);
  EXPECT_LT(RotationAngle(N.linear() * reference.linear().transpose()), 0.2);
  EXPECT_NEAR(RotationError(group, X.linear(), N.linear()), 0, 1e-6);
  EXPECT_EQ(N.translation(), X.translation());
}

TEST(SymmetryTest, RefusesWhatIsNoRotation) {
  EXPECT_THROW(MakeSymmetryGroup({2 * Matrix3::Identity()}, {}), std::invalid_argument);
  EXPECT_THROW(MakeSymmetryGroup({-Matrix3::Identity()}, {}), std::invalid_argument);
  EXPECT_THROW(MakeSymmetryGroup({ExpRotation({0, 0, 1})}, {}), std::invalid_argument);  // 1 rad never closes
  EXPECT_THROW(MakeSymmetryGroup({}, {Vector3::Zero()}), std::invalid_argument);
}

}  // namespace
}  // namespace coach
