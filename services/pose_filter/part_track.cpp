#include "services/pose_filter/part_track.h"

#include <algorithm>
#include <cmath>

namespace coach {
namespace {

Matrix6 Diagonal(double position, double rotation) {
  Matrix6 m = Matrix6::Zero();
  m.diagonal().head<3>().setConstant(position * position);
  m.diagonal().tail<3>().setConstant(rotation * rotation);
  return m;
}

double Confidence(const Score& score) { return std::clamp(score.agreement(), 0.0, 1.0); }

void Describe(const PoseCandidate& candidate, Track& track) {
  track.visible_fraction = candidate.visible_fraction();
  track.confidence = Confidence(candidate.score);
  track.pixels = candidate.pixels;
  track.log_likelihood = candidate.score.log_likelihood;
}

constexpr double kLongestPrediction = 0.2;  // s; hands don't keep their way for longer

/// What dt adds to the uncertainty of a part that is seen.
Matrix6 Growth(const Track& track, double dt, const TrackOptions& options) {
  if (track.moving) return Diagonal(options.moving_position * dt, options.moving_rotation * dt);
  return Diagonal(options.still_position * std::sqrt(dt), options.still_rotation * std::sqrt(dt));
}

}  // namespace

Pose PredictPose(const Track& track, double dt) {
  if (!track.moving || track.status != PartStatus::kTracked) return track.X_TP;
  return Perturb(track.X_TP, track.velocity * std::min(dt, kLongestPrediction));
}

bool Believable(const PoseCandidate& candidate, const TrackOptions& options) {
  return candidate.score.agreement() >= options.least_agreement &&
         (candidate.evidence.contour_judged < options.least_judged ||
          candidate.outline_support() >= options.least_outline);
}

void Fuse(const PoseCandidate& candidate, const Pose& X_TC, double dt, const TrackOptions& options, Track& track) {
  const Pose measured = X_TC * candidate.X_CP;
  const Matrix6 information = RotateCovariance(X_TC.linear(), candidate.evidence.information);
  // A small piece seen past a hand is more often another's edge than the noise of its pixels says.
  const double visible = candidate.visible_fraction();
  const double caution = 1 + options.small_piece * options.small_piece / (visible * visible + 1e-3);
  const Matrix6 noise = caution * (information + Matrix6::Identity() * 1e-3).inverse();
  const Pose before = track.X_TP;
  // Does the pose say that the part moves? Judged against a part at rest.
  const Vector6 shift = Difference(before, measured);
  const Matrix6 spread = noise + track.covariance + Diagonal(options.floor_position, options.floor_rotation);
  const bool moves = shift.dot(spread.ldlt().solve(shift)) > options.moving_threshold;
  track.moving_for = moves ? 0 : track.moving_for + dt;
  track.moving = moves || track.moving_for < 0.25;
  const Pose predicted = track.moving ? Perturb(track.X_TP_free, track.velocity * dt) : track.X_TP_free;
  const Matrix6 prior = track.covariance_free + Growth(track, dt, options);
  const Vector6 innovation = Difference(predicted, measured);
  const Matrix6 gain = prior * (prior + noise).inverse();
  track.X_TP_free = Perturb(predicted, gain * innovation);
  track.covariance_free = (Matrix6::Identity() - gain) * prior;
  track.covariance_free = (0.5 * (track.covariance_free + track.covariance_free.transpose())).eval();
  track.X_TP = track.X_TP_free;
  track.covariance = track.covariance_free;
  if (track.hidden_for > 0 || !track.moving) {
    track.velocity.setZero();
  } else if (dt > 0) {
    track.velocity = 0.4 * track.velocity + 0.6 * Difference(before, track.X_TP) / dt;
  }
  track.status = PartStatus::kTracked;
  track.hidden_for = 0;
  track.carried = false;
  track.bad = 0;
  Describe(candidate, track);
  if (track.visible_fraction >= options.rest_visible)
    track.X_TP_rest = track.moving_for > options.rest_time ? std::optional(track.X_TP) : std::nullopt;
}

bool Constrain(const Pose& X_TP, const Matrix6& covariance, Track& track) {
  const Vector6 apart = Difference(track.X_TP, X_TP);
  const Matrix6 sum = track.covariance + covariance;
  const Eigen::LDLT<Matrix6> solver(sum);
  if (apart.dot(solver.solve(apart)) > 30) return false;
  const Matrix6 gain = track.covariance * sum.inverse();
  track.X_TP = Perturb(track.X_TP, gain * apart);
  track.covariance = (Matrix6::Identity() - gain) * track.covariance;
  track.covariance = (0.5 * (track.covariance + track.covariance.transpose())).eval();
  return true;
}

void Restart(const PoseCandidate& candidate, const Pose& X_TC, Track& track) {
  const Pose anchor = track.status == PartStatus::kAbsent ? X_TC * candidate.X_CP : track.anchor;
  track = Track();
  track.anchor = anchor;
  track.status = PartStatus::kTracked;
  track.X_TP = track.X_TP_free = X_TC * candidate.X_CP;
  track.covariance =
      (RotateCovariance(X_TC.linear(), candidate.evidence.information) + Matrix6::Identity() * 1e-3).inverse();
  track.covariance_free = track.covariance;
  Describe(candidate, track);
}

void Coast(PartStatus status, double dt, const TrackOptions& options, Track& track) {
  if (track.hidden_for == 0) track.carried = track.moving;
  const double before = track.hidden_for, after = before + dt;
  if (track.carried) {
    // The distance covered grows like the time: the difference of two squares keeps it independent of the frame rate.
    const double growth = options.carried_growth * options.carried_growth * (after * after - before * before);
    track.covariance += Diagonal(std::sqrt(std::max(0.0, growth)), 5 * std::sqrt(std::max(0.0, growth)));
  } else {
    track.covariance += Diagonal(options.hidden_growth * std::sqrt(dt), 10 * options.hidden_growth * std::sqrt(dt));
  }
  // Nowhere beyond a table's size, and no rotation is farther than half a turn.
  const double p = track.covariance.diagonal().head<3>().maxCoeff();
  if (p > 0.25) track.covariance *= 0.25 / p;
  track.hidden_for = after;
  track.velocity.setZero();
  track.moving = false;
  track.status = status;
  track.visible_fraction = 0;
  track.confidence = status == PartStatus::kLost ? 0 : track.confidence * std::exp(-dt);
  track.X_TP_free = track.X_TP;
  track.covariance_free = track.covariance;
}

void Settle(const Pose& X_TP_before, double dt, const TrackOptions& options, Track& track) {
  const double moved = (track.X_TP.translation() - X_TP_before.translation()).norm();
  track.calm_for = moved > options.hasty ? 0 : track.calm_for + dt;
  const bool jumped = moved > options.jump;
  track.settled_for = jumped || track.missing() ? 0 : track.settled_for + dt;
  if (track.settled_for > options.settle_time) track.anchor = track.X_TP;
}

PartEstimate Publish(const Track& track, const TrackOptions& options) {
  PartEstimate out;
  out.X_TP = track.X_TP;
  out.velocity = track.velocity;
  out.covariance = track.covariance + Diagonal(options.floor_position, options.floor_rotation);
  out.visible_fraction = track.visible_fraction;
  const bool poor = track.confidence < options.hasty_confidence || track.visible_fraction < options.hasty_visible;
  const bool doubtful = track.bad > 0 || (track.calm_for < options.calm_time && poor);
  out.status = track.status == PartStatus::kTracked && doubtful ? PartStatus::kOccluded : track.status;
  out.confidence = track.confidence;
  out.ambiguous_with = track.ambiguous_with;
  out.ambiguous_probability = track.ambiguous_probability;
  out.identity_exchange = track.exchanged_with;
  return out;
}

}  // namespace coach
