#include "services/pose_filter/process_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "services/pose_filter/occlusion.h"

namespace coach {
namespace {

struct Moments {
  double q = 0, qq = 0, v = 0, vv = 0, qv = 0;
};

Moments Simulate(double dt, int frames, int axis, double v0) {
  Random random(11);
  Moments m;
  const int n = 20000;
  for (int i = 0; i < n; ++i) {
    MotionState state;
    state.v[axis] = v0;
    for (int f = 0; f < frames; ++f) Propagate({}, dt, random, state);
    const double q = state.q[axis], v = state.v[axis];
    m.q += q / n;
    m.v += v / n;
    m.qq += q * q / n;
    m.vv += v * v / n;
    m.qv += q * v / n;
  }
  return m;
}

// One step of 1/30 s is the paper's: both noises are the same number.
TEST(ProcessModel, OneStepIsThePapers) {
  Random random(1), same(1);
  MotionState state;
  state.v << 0.01, 0, 0, 0, 0.1, 0;
  Propagate({}, 1 / 30.0, random, state);
  for (int i = 0; i < 6; ++i) {
    const double v = i == 0 ? 0.01 : i == 4 ? 0.1 : 0;
    const double noise = (i < 3 ? 0.0025 : 0.02) * same.Normal();
    EXPECT_NEAR(state.v[i], 0.8 * v + noise, 1e-9);
    EXPECT_NEAR(state.q[i], 0.8 * v + noise, 1e-9);
  }
}

TEST(ProcessModel, TwoStepsByTheEquations) {
  // q2 = 0.8 v0 + n1 + 0.8 (0.8 v0 + n1) + n2, v2 = 0.64 v0 + 0.8 n1 + n2
  const double s2 = 0.0025 * 0.0025, v0 = 0.02;
  const Moments m = Simulate(2 / 30.0, 1, 1, v0);
  EXPECT_NEAR(m.q, 1.44 * v0, 2e-4);
  EXPECT_NEAR(m.v, 0.64 * v0, 2e-4);
  EXPECT_NEAR(m.qq - m.q * m.q, (1.8 * 1.8 + 1) * s2, 0.05 * 4.24 * s2);
  EXPECT_NEAR(m.vv - m.v * m.v, 1.64 * s2, 0.05 * 1.64 * s2);
  EXPECT_NEAR(m.qv - m.q * m.v, (1.8 * 0.8 + 1) * s2, 0.05 * 2.44 * s2);
}

// A dropped frame does not change the model: 15 Hz and 30 Hz agree.
TEST(ProcessModel, FrameRateDoesNotMatter) {
  const Moments fast = Simulate(1 / 30.0, 10, 4, 0), slow = Simulate(5 / 30.0, 2, 4, 0);
  EXPECT_NEAR(slow.qq / fast.qq, 1, 0.05);
  EXPECT_NEAR(slow.vv / fast.vv, 1, 0.05);
  const Moments fine = Simulate(1 / 120.0, 40, 4, 0);
  EXPECT_NEAR(fine.qq / fast.qq, 1, 0.25) << "part steps are an approximation";
}

TEST(ProcessModel, RoundedTimeStampsAreWholeSteps) {
  Random a(2), b(2);
  MotionState x, y;
  Propagate({}, 0.033333, a, x);
  Propagate({}, 0.033334, b, y);
  EXPECT_NEAR((x.q - y.q).norm(), 0, 1e-5);
  EXPECT_EQ(a.Bits(), b.Bits()) << "the same number of random numbers";
}

TEST(ProcessModel, GapsAreBoundedAndTimeNeverRunsBackwards) {
  Random random(2);
  MotionState state;
  state.v.setConstant(0.01);
  const MotionState before = state;
  Propagate({}, -1, random, state);
  EXPECT_EQ(state.q, before.q);
  Propagate({}, 1e9, random, state);
  EXPECT_LT(state.q.norm(), 3);
  EXPECT_TRUE(state.q.allFinite());
}

TEST(Occlusion, ChainByItsMatrix) {
  // One second, then the matrix power for whole seconds.
  const OcclusionChain chain;
  double o = 0.35;
  for (int seconds = 1; seconds <= 5; ++seconds) {
    o = o * chain.stays_occluded + (1 - o) * chain.becomes_occluded;
    EXPECT_NEAR(PredictOcclusion(chain, seconds)(0.35F), o, 1e-6);
  }
  const OcclusionStep third = PredictOcclusion(chain, 1 / 3.0);
  EXPECT_NEAR(third(third(third(0.9F))), PredictOcclusion(chain, 1)(0.9F), 1e-6);
  EXPECT_NEAR(PredictOcclusion(chain, 0)(0.4F), 0.4, 1e-7);
  EXPECT_NEAR(PredictOcclusion(chain, 1e6)(0.9F), 0.25, 1e-6) << "a / (1 - c)";
}

}  // namespace
}  // namespace coach
