#include "services/pose_filter/particle_weights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace coach {
namespace {

TEST(Random, MomentsAndRepeatability) {
  Random random(5), again(5), other(6);
  double sum = 0, squares = 0, fourth = 0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double x = random.Normal();
    EXPECT_EQ(x, again.Normal());
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
  }
  EXPECT_NEAR(sum / n, 0, 0.01);
  EXPECT_NEAR(squares / n, 1, 0.02);
  EXPECT_NEAR(fourth / n, 3, 0.1);
  EXPECT_NE(random.Bits(), other.Bits());
  std::vector<int> histogram(7);
  for (int i = 0; i < 70000; ++i) ++histogram[static_cast<size_t>(random.Below(7))];
  for (const int count : histogram) EXPECT_NEAR(count, 10000, 400);
}

// The first outputs of the reference implementation's arithmetic, worked out independently (Python) for seed 0.
TEST(Random, GoldenValues) {
  Random random(0);
  EXPECT_EQ(random.Bits(), 0x53175d61490b23dfULL);
  EXPECT_EQ(random.Bits(), 0x61da6f3dc380d507ULL);
}

TEST(ParticleWeights, Normalise) {
  const double none = -std::numeric_limits<double>::infinity();
  std::vector<double> weights;
  NormaliseWeights({-1000, -1000 + std::log(3.0), none}, weights);
  EXPECT_NEAR(weights[0], 0.25, 1e-12);
  EXPECT_NEAR(weights[1], 0.75, 1e-12);
  EXPECT_EQ(weights[2], 0);
  NormaliseWeights({none, none}, weights);
  EXPECT_EQ(weights, (std::vector<double>{0.5, 0.5}));
  NormaliseWeights({std::nan(""), 0}, weights);
  EXPECT_EQ(weights, (std::vector<double>{0, 1}));
}

TEST(ParticleWeights, Divergence) {
  EXPECT_NEAR(DivergenceFromUniform({0.25, 0.25, 0.25, 0.25}), 0, 1e-12);
  EXPECT_NEAR(DivergenceFromUniform({0, 1, 0, 0}), std::log(4.0), 1e-12);
  EXPECT_NEAR(DivergenceFromUniform({0.5, 0.5, 0, 0}), std::log(2.0), 1e-12);
}

TEST(ParticleWeights, SystematicGivesFloorOrCeiling) {
  Random random(3);
  for (int k = 0; k < 200; ++k) {
    std::vector<double> weights(37);
    double sum = 0;
    for (double& w : weights) sum += w = std::pow(random.Uniform(), 4);
    for (double& w : weights) w /= sum;
    std::vector<int> parents, copies(weights.size());
    SystematicResample(weights, random, parents);
    ASSERT_EQ(parents.size(), weights.size());
    EXPECT_TRUE(std::is_sorted(parents.begin(), parents.end()));
    for (const int p : parents) ++copies[static_cast<size_t>(p)];
    for (size_t i = 0; i < weights.size(); ++i) {
      const double expected = weights[i] * static_cast<double>(weights.size());
      EXPECT_GE(copies[i], std::floor(expected - 1e-9));
      EXPECT_LE(copies[i], std::ceil(expected + 1e-9));
    }
  }
}

}  // namespace
}  // namespace coach
