#include "common/geometry/pose.h"

#include <gtest/gtest.h>

#include <random>

namespace coach {
namespace {

Vector6 RandomMotion(std::mt19937& rng, double metres, double radians) {
  std::normal_distribution<double> n;
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = n(rng) * (i < 3 ? metres : radians);
  return xi;
}

Pose RandomPose(std::mt19937& rng) { return Perturb(Pose::Identity(), RandomMotion(rng, 1, 1)); }

TEST(PoseTest, ExpAndLogAreInverse) {
  std::mt19937 rng(1);
  for (int i = 0; i < 1000; ++i) {
    Vector3 w = RandomMotion(rng, 1, 1).tail<3>();
    if (i % 10 == 0) w *= 1e-9;
    if (w.norm() > 3.14) w *= 3.14 / w.norm();
    EXPECT_NEAR((LogRotation(ExpRotation(w)) - w).norm(), 0, 1e-9);
    EXPECT_NEAR((ExpRotation(w) * ExpRotation(w).transpose() - Matrix3::Identity()).norm(), 0, 1e-12);
  }
}

TEST(PoseTest, LogNearHalfTurn) {
  for (double angle : {3.1, 3.1415, 3.14159265}) {
    const Vector3 w = angle * Vector3(1, 2, -2) / 3;
    EXPECT_NEAR((LogRotation(ExpRotation(w)) - w).norm(), 0, 1e-6);
  }
}

TEST(PoseTest, DifferenceUndoesPerturb) {
  std::mt19937 rng(2);
  for (int i = 0; i < 200; ++i) {
    const Pose X = RandomPose(rng);
    const Vector6 xi = RandomMotion(rng, 1, 0.5);
    EXPECT_NEAR((Difference(X, Perturb(X, xi)) - xi).norm(), 0, 1e-9);
  }
}

TEST(PoseTest, CovarianceOfCompositionMatchesSamples) {
  std::mt19937 rng(3);
  const Pose X_AB = RandomPose(rng), X_BC = RandomPose(rng);
  Matrix6 a = Matrix6::Zero(), b = Matrix6::Zero();
  a.diagonal() << 1, 2, 3, 1, 2, 3;
  b.diagonal() << 3, 2, 1, 1, 1, 2;
  a *= 1e-8;
  b *= 1e-8;
  Matrix6 sampled = Matrix6::Zero();
  constexpr int kSamples = 40000;
  for (int i = 0; i < kSamples; ++i) {
    const Vector6 xa = a.cwiseSqrt() * RandomMotion(rng, 1, 1), xb = b.cwiseSqrt() * RandomMotion(rng, 1, 1);
    const Vector6 d = Difference(X_AB * X_BC, Perturb(X_AB, xa) * Perturb(X_BC, xb));
    sampled += d * d.transpose() / kSamples;
  }
  const Matrix6 expected = ComposeCovariance(X_AB, a, X_BC, b);
  EXPECT_LT((sampled - expected).norm() / expected.norm(), 0.03);
}

TEST(PoseTest, MakePoseProjectsOntoRotations) {
  Matrix3 R = ExpRotation({0.1, 0.2, 0.3});
  R(0, 0) += 1e-3;
  EXPECT_NEAR(MakePose(R, {1, 2, 3}).linear().determinant(), 1, 1e-12);
}

}  // namespace
}  // namespace coach
