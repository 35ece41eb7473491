#include "services/pose_filter/part_track.h"

#include <gtest/gtest.h>

#include "tests/support/drawn_observation.h"

namespace coach {
namespace {

const TrackOptions kOptions;
constexpr double kFrame = 1.0 / 30;

Pose At(double x) { return MakePose(Matrix3::Identity(), {x, 0, 0.015}); }

Track Seen(double confidence) {
  Track track;
  track.status = PartStatus::kTracked;
  track.confidence = confidence;
  track.visible_fraction = 1;
  return track;
}

/// A fit of which `inlier` of 100 samples are seen, `wrong` are of another colour and the rest is hidden.
PoseCandidate Fit(const Pose& X_CP, int inlier, int wrong = 0) {
  PoseCandidate c;
  c.X_CP = X_CP;
  c.evidence.information = Matrix6::Identity() * 1e6;
  c.full_samples = c.score.covered = 100;
  c.score.inlier = inlier;
  c.score.wrong_colour = wrong;
  c.score.hidden = 100 - inlier - wrong;
  return c;
}

PartStatus Status(const Track& track) { return Publish(track, kOptions).status; }

TEST(PartTrack, APoorFitInFastMotionIsNotCalledTracked) {
  const double poor = kOptions.hasty_confidence - 0.05, good = kOptions.hasty_confidence + 0.05;
  for (const double confidence : {poor, good}) {
    Track track = Seen(confidence);
    track.X_TP = At(0);
    Settle(track.X_TP, kFrame, kOptions, track);
    EXPECT_EQ(Status(track), PartStatus::kTracked) << "at rest, " << confidence;
    track.X_TP = At(2 * kOptions.hasty);
    Settle(At(0), kFrame, kOptions, track);
    EXPECT_EQ(Status(track), confidence == poor ? PartStatus::kOccluded : PartStatus::kTracked) << confidence;
    EXPECT_EQ(track.status, PartStatus::kTracked) << "it is followed all the same";
    double calm = 0;
    while (calm < kOptions.calm_time + kFrame) {
      Settle(track.X_TP, kFrame, kOptions, track);
      calm += kFrame;
    }
    EXPECT_EQ(Status(track), PartStatus::kTracked) << "calm again, " << confidence;
  }
}

TEST(PartTrack, ASmallPieceInFastMotionIsNotCalledTracked) {
  for (const double visible : {kOptions.hasty_visible - 0.05, kOptions.hasty_visible + 0.05}) {
    Track track = Seen(1);
    track.visible_fraction = visible;
    Settle(track.X_TP, kFrame, kOptions, track);
    EXPECT_EQ(Status(track), PartStatus::kTracked) << "at rest";
    track.X_TP = At(2 * kOptions.hasty);
    Settle(At(0), kFrame, kOptions, track);
    EXPECT_EQ(Status(track), visible < kOptions.hasty_visible ? PartStatus::kOccluded : PartStatus::kTracked);
  }
}

TEST(PartTrack, AFitThatTheImageContradictsIsNotCalledTracked) {
  Track track = Seen(0.9);
  track.bad = 1;
  EXPECT_EQ(Status(track), PartStatus::kOccluded);
  EXPECT_TRUE(track.missing());
  for (const PartStatus status : {PartStatus::kAbsent, PartStatus::kLost, PartStatus::kOutOfView}) {
    track.status = status;
    EXPECT_EQ(Status(track), status);
  }
}

TEST(PartTrack, APieceOfSomethingLargerIsNotBelieved) {
  PoseCandidate c = Fit(At(0), 100);
  EXPECT_TRUE(Believable(c, kOptions)) << "no outline to judge";
  c.evidence.contour_judged = 50;
  c.evidence.contour_used = 45;
  EXPECT_TRUE(Believable(c, kOptions));
  c.evidence.contour_used = 5;
  EXPECT_FALSE(Believable(c, kOptions)) << "it goes on beyond the outline";
  c.evidence.contour_judged = kOptions.least_judged - 1;
  EXPECT_TRUE(Believable(c, kOptions)) << "too little of the outline to say";
  EXPECT_FALSE(Believable(Fit(At(0), 30, 70), kOptions)) << "of another colour";
}

TEST(PartTrack, ASmallPieceIsWorthLess) {
  // A prior so wide that the posterior is the measurement's noise: doubled at `small_piece`, five times at half of it.
  const auto variance = [](double visible) {
    Track track = Seen(1);
    track.covariance = track.covariance_free = Matrix6::Identity() * 1e3;
    Fuse(Fit(At(0), static_cast<int>(std::lround(100 * visible))), Pose::Identity(), kFrame, kOptions, track);
    EXPECT_NEAR(track.visible_fraction, visible, 0.006);
    return track.covariance(0, 0);
  };
  const double whole = variance(1);
  EXPECT_NEAR(whole, 1e-6, 5e-8);
  EXPECT_NEAR(variance(kOptions.small_piece) / whole, 2, 0.15);
  EXPECT_NEAR(variance(kOptions.small_piece / 2) / whole, 5, 1.2);
}

TEST(PartTrack, VelocityNeedsAMovingPart) {
  Track track = Seen(1);
  track.X_TP = track.X_TP_free = At(0);
  track.covariance = track.covariance_free = Matrix6::Identity() * 1e-7;
  for (int k = 0; k < 30; ++k) Fuse(Fit(At(0), 100), Pose::Identity(), kFrame, kOptions, track);
  EXPECT_FALSE(track.moving);
  EXPECT_EQ(track.velocity.norm(), 0);
  EXPECT_LT(PositionError(PredictPose(track, kFrame), At(0)), 1e-9);
  for (int k = 1; k <= 10; ++k) Fuse(Fit(At(0.01 * k), 100), Pose::Identity(), kFrame, kOptions, track);
  EXPECT_TRUE(track.moving);
  EXPECT_NEAR(track.velocity.x(), 0.3, 0.03);
  EXPECT_NEAR(PredictPose(track, kFrame).translation().x(), 0.11, 0.002);
}

TEST(PartTrack, ACoveredPartKeepsThePlaceWhereItLayStill) {
  Track track = Seen(1);
  track.X_TP = track.X_TP_free = At(0);
  track.covariance = track.covariance_free = Matrix6::Identity() * 1e-7;
  const auto see = [&](double x, double visible, int frames) {
    for (int k = 0; k < frames; ++k)
      Fuse(Fit(At(x), static_cast<int>(100 * visible)), Pose::Identity(), kFrame, kOptions, track);
  };
  const int still = static_cast<int>(std::ceil(kOptions.rest_time / kFrame)) + 1;
  see(0, 1, still / 2);
  EXPECT_FALSE(track.X_TP_rest) << "not for long enough";
  see(0, 1, still);
  ASSERT_TRUE(track.X_TP_rest);
  see(0.012, 0.3, 5);
  ASSERT_TRUE(track.X_TP_rest);
  EXPECT_LT(PositionError(*track.X_TP_rest, At(0)), 1e-6) << "what a covered part seems to do is not believed";
  Coast(PartStatus::kOccluded, kFrame, kOptions, track);
  EXPECT_TRUE(track.X_TP_rest);
  see(0.1, 1, 1);
  EXPECT_FALSE(track.X_TP_rest) << "seen well to move";
}

TEST(PartTrack, DoubtOfAHiddenPartGrowsTheSameAtAnyFrameRate) {
  for (const bool carried : {false, true}) {
    std::vector<double> spread;
    for (const int steps : {7, 15, 60}) {
      Track track = Seen(1);
      track.moving = carried;
      track.covariance = track.covariance_free = Matrix6::Identity() * 1e-8;
      for (int k = 0; k < steps; ++k) Coast(PartStatus::kOccluded, 1.0 / steps, kOptions, track);
      spread.push_back(std::sqrt(track.covariance(0, 0)));
      EXPECT_EQ(track.visible_fraction, 0);
    }
    const double expected = carried ? kOptions.carried_growth : kOptions.hidden_growth;  // after one second
    for (const double s : spread) EXPECT_NEAR(s, expected, 0.02 * expected) << carried;
  }
}

}  // namespace
}  // namespace coach
