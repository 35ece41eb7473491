#include "services/pose_filter/pair_evidence.h"

#include <gtest/gtest.h>

#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

/// Two bricks that are connected in an L, or by mistake in a line.
Task Bricks() {
  Task task = TestTask({TestType("long", BoxMesh({0.12, 0.03, 0.03}), true, 2),
                        TestType("short", BoxMesh({0.09, 0.03, 0.03}), false, 1)});
  task.types[0].symmetries = MakeSymmetryGroup({ExpRotation({0, std::numbers::pi, 0})}, {});
  task.slots = {{"a", 0}, {"b", 1}};
  task.connections.resize(1);
  task.connections[0].name = "c";
  task.connections[0].slot_a = 0;
  task.connections[0].slot_b = 1;
  task.connections[0].X_AB = MakePose(ExpRotation({0, 0, std::numbers::pi / 2}), {0.045, 0.06, 0});
  task.mistakes = {{"line", 0, 1, MakePose(Matrix3::Identity(), {0.105, 0, 0})}};
  return task;
}

Track Seen(const Pose& X_TP, double position = 0.001, double rotation = 0.01) {
  Track track;
  track.status = PartStatus::kTracked;
  track.X_TP = track.X_TP_free = X_TP;
  track.covariance_free = Matrix6::Zero();
  track.covariance_free.diagonal().head<3>().setConstant(position * position);
  track.covariance_free.diagonal().tail<3>().setConstant(rotation * rotation);
  track.covariance = track.covariance_free;
  track.visible_fraction = 0.8;
  track.pixels = 1000;
  return track;
}

const Pose kAt = MakePose(ExpRotation({0, 0, 0.7}), {0.1, -0.05, 0.015});
const Pose kFar = MakePose(Matrix3::Identity(), {-0.4, 0.3, 0.015});

std::vector<PairEvidence> PairsOf(PairFinder& finder, int64_t utime, const std::vector<Track>& tracks) {
  std::vector<PairEvidence> pairs;
  finder.Find(utime, tracks, pairs);
  return pairs;
}

TEST(PairEvidence, AConnectedPairIsFoundWithItsCandidate) {
  const Task task = Bricks();
  PairFinder finder(task);
  const Pose X_AB = task.connections[0].X_AB;
  const auto pairs = PairsOf(finder, 1000, {Seen(kAt), Seen(kFar), Seen(kAt * X_AB)});
  ASSERT_EQ(pairs.size(), 1u);
  const PairEvidence& p = pairs[0];
  EXPECT_EQ(p.part_a, 0);
  EXPECT_EQ(p.part_b, 2);
  EXPECT_LT(PositionError(p.X_AB, X_AB) + AngleError(p.X_AB, X_AB), 1e-9);
  EXPECT_EQ(p.candidate_kind, CandidateKind::kConnection);
  EXPECT_EQ(p.candidate, 0);
  EXPECT_GT(p.log_evidence, 0) << "exactly in place: one body";
  EXPECT_NEAR(p.surface_distance, 0, 0.001) << "the faces touch";
  EXPECT_EQ(p.pixels, 2000);
  EXPECT_EQ(p.visible_fraction[0], 0.8);
  EXPECT_FALSE(p.constrained);
}

TEST(PairEvidence, SymmetricAndMistakenJoints) {
  const Task task = Bricks();
  PairFinder finder(task);
  // The long brick turned half round its y axis looks the same.
  Pose turned = kAt;
  turned.linear() = turned.linear() * ExpRotation({0, std::numbers::pi, 0});
  auto pairs = PairsOf(finder, 1000, {Seen(turned), Seen(kFar), Seen(kAt * task.connections[0].X_AB)});
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].candidate_kind, CandidateKind::kConnection);
  EXPECT_GT(pairs[0].log_evidence, 0);
  pairs = PairsOf(finder, 2000, {Seen(kAt), Seen(kFar), Seen(kAt * task.mistakes[0].X_AB)});
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].candidate_kind, CandidateKind::kMistake);
  EXPECT_EQ(pairs[0].candidate, 0);
  EXPECT_GT(pairs[0].log_evidence, 0);
  // 2 cm beside the joint, eight standard deviations: two bodies.
  pairs = PairsOf(
      finder, 3000,
      {Seen(kAt), Seen(kFar), Seen(kAt * task.connections[0].X_AB * MakePose(Matrix3::Identity(), {0, 0, 0.020}))});
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_LT(pairs[0].log_evidence, 0);
}

TEST(PairEvidence, OnlyPartsThatAreSeenAndNear) {
  const Task task = Bricks();
  PairFinder finder(task);
  const Pose b = kAt * task.connections[0].X_AB;
  Track hidden = Seen(b);
  hidden.status = PartStatus::kOccluded;
  EXPECT_TRUE(PairsOf(finder, 1000, {Seen(kAt), Seen(kFar), hidden}).empty());
  // The short brick leaves along its own axis: surfaces 2 cm, then 4 cm apart.
  for (const auto& [gap, pairs] : {std::pair{0.02, 1u}, {0.04, 0u}}) {
    const Pose away = b * MakePose(Matrix3::Identity(), {gap, 0, 0});
    const auto found = PairsOf(finder, 2000, {Seen(kAt), Seen(kFar), Seen(away)});
    ASSERT_EQ(found.size(), pairs) << gap;
    for (const PairEvidence& p : found) EXPECT_NEAR(p.surface_distance, gap, 0.003);
  }
}

// First-order propagation against drawing both poses at random.
TEST(PairEvidence, CovarianceIsThatOfDrawnPoses) {
  const Task task = Bricks();
  PairOptions options;
  options.floor_position = options.floor_rotation = 0;
  PairFinder finder(task, options);
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  double trace_before = 0;
  for (const double lever : {0.045, 0.075}) {
    const Pose A = kAt, B = kAt * MakePose(ExpRotation({0, 0, std::numbers::pi / 2}), {0.045, 0, 0}) *
                            MakePose(Matrix3::Identity(), {lever, 0, 0});
    const Track track_a = Seen(A, 0.001, 0.02), track_b = Seen(B, 0.002, 0.01);
    const auto pairs = PairsOf(finder, 1000, {track_a, Seen(kFar), track_b});
    ASSERT_EQ(pairs.size(), 1u);
    Matrix6 sampled = Matrix6::Zero();
    const int n = 20000;
    for (int k = 0; k < n; ++k) {
      Vector6 e_a, e_b;
      for (int i = 0; i < 6; ++i) {
        e_a[i] = normal(generator) * (i < 3 ? 0.001 : 0.02);
        e_b[i] = normal(generator) * (i < 3 ? 0.002 : 0.01);
      }
      const Vector6 e = Difference(pairs[0].X_AB, Perturb(A, e_a).inverse() * Perturb(B, e_b));
      sampled += e * e.transpose() / n;
    }
    // Relative error of a variance from n samples: sqrt(2 / n) = 1 %; linearisation at 0.02 rad: less.
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(pairs[0].covariance(i, i) / sampled(i, i), 1, 0.06) << i;
    EXPECT_LT((pairs[0].covariance - sampled).topLeftCorner(3, 3).norm(), 0.06 * sampled.topLeftCorner(3, 3).norm());
    const double trace = pairs[0].covariance.topLeftCorner(3, 3).trace();
    EXPECT_GT(trace, trace_before) << "grows with the lever";
    trace_before = trace;
  }
}

TEST(PairEvidence, MotionOverHalfASecond) {
  const Task task = Bricks();
  PairFinder finder(task);
  std::vector<PairEvidence> pairs;
  for (int k = 0; k <= 30; ++k) {  // 10 cm/s and 0.5 rad/s as one body
    const double t = k / 30.0;
    const Pose A = MakePose(ExpRotation({0, 0, 0.5 * t}), {0.1 * t, 0, 0.015});
    pairs = PairsOf(finder, k * 1000000LL / 30, {Seen(A), Seen(kFar), Seen(A * task.connections[0].X_AB)});
    ASSERT_EQ(pairs.size(), 1u);
  }
  EXPECT_NEAR(pairs[0].motion[0], 0.05, 0.0034);  // within a frame
  EXPECT_NEAR(pairs[0].motion[1], 0.25, 0.017);
  EXPECT_LT(pairs[0].relative_motion[0] + pairs[0].relative_motion[1], 1e-9);
  // Time going backwards: nothing is remembered.
  pairs = PairsOf(finder, 500000, {Seen(kAt), Seen(kFar), Seen(kAt * task.connections[0].X_AB)});
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].motion[0], 0);
  // Now B alone slides.
  for (int k = 1; k <= 15; ++k) {
    const Pose slid = kAt * task.connections[0].X_AB * MakePose(Matrix3::Identity(), {0, 0, 0.001 * k});
    pairs = PairsOf(finder, 500000 + k * 30000, {Seen(kAt), Seen(kFar), Seen(slid)});
  }
  EXPECT_NEAR(pairs[0].relative_motion[0], 0.015, 1e-6);
  EXPECT_EQ(pairs[0].motion[0], 0);
}

TEST(PairEvidence, OverlapIsTheShareOfTheSurfaceInside) {
  const Task task = Bricks();
  const PairFinder finder(task);
  const Pose same = kAt;
  EXPECT_NEAR(finder.Overlap(0, kAt, 1, same, -0.001), 1, 1e-9);
  EXPECT_EQ(finder.Overlap(0, kAt, 1, kFar, 0), 0);
  // The other one, 1 cm wider on every side, reaches over half of the length. Deeper than 4 mm: 56 of the 120 mm of the
  // four sides (14,400 mm^2) and one end (900 mm^2), of 16,200 mm^2.
  Task big = task;
  big.types[1].mesh = BoxMesh({0.12, 0.05, 0.05});
  const PairFinder nested(big);
  const Pose half = kAt * MakePose(Matrix3::Identity(), {0.06, 0, 0});
  EXPECT_NEAR(nested.Overlap(0, kAt, 2, half, 0.004), (14400 * 56 / 120.0 + 900) / 16200, 0.04);
}

}  // namespace
}  // namespace coach
