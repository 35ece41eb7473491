// What the filter believes of one part, and how a measurement or its absence changes it.
#pragma once

#include <optional>

#include "common/assembly/part_poses.h"
#include "services/pose_filter/pose_search.h"

namespace coach {

struct TrackOptions {
  double still_position = 0.0004;  ///< m per sqrt(s): walk of a part at rest
  double still_rotation = 0.004;   ///< rad per sqrt(s)
  double moving_position = 0.35;   ///< m/s: a hand's change of place between two frames that velocity does not predict
  double moving_rotation = 2.0;    ///< rad/s
  double moving_threshold =
      22;  ///< squared Mahalanobis distance (6 degrees of freedom) of a pose that says the part moves
  double floor_position = 0.0008;  ///< m, standard deviation added to what is published
  double floor_rotation = 0.010;   ///< rad
  double hidden_growth = 0.008;    ///< m per sqrt(s): a part at rest that nothing seems to touch
  double carried_growth = 0.10;    ///< m per s: a part that was moving when it was hidden
  double small_piece = 0.17;       ///< visible share at which the variance of a fit is doubled
  double least_open = 0.12;        ///< share of the silhouette that must be open for an update
  double least_agreement = 0.45;   ///< Score::agreement below which the pose is not believed
  double least_outline = 0.35;     ///< PoseCandidate::outline_support below which it is a piece of something larger,
  int least_judged = 20;           ///< if so many outline points are open to judgement
  double jump = 0.05;              ///< m in one frame: the part may have been taken for another
  double settle_time = 1.0;        ///< s without a jump after which an identity is beyond doubt
  int bad_frames = 2;              ///< in a row until the part is lost
  double hasty = 0.02;             ///< m in one frame: farther than a refinement follows surely
  double calm_time = 0.2;          ///< s without that, after which a fit is trusted again
  double hasty_confidence = 0.75;  ///< of a fit that is trusted all the same,
  double hasty_visible = 0.3;      ///< if so much of the part is seen
  double rest_visible = 0.6;       ///< visible share of a part that is seen to lie still
  double rest_time = 0.3;          ///< s without a move after which it does
};

struct Track {
  PartStatus status = PartStatus::kAbsent;
  Pose X_TP = Pose::Identity();       ///< what is published: with the constraints of believed connections
  Pose X_TP_free = Pose::Identity();  ///< by the images alone, since the part was last found
  Matrix6 covariance_free = Matrix6::Identity() * 0.25;
  Vector6 velocity = Vector6::Zero();               ///< table frame
  Matrix6 covariance = Matrix6::Identity() * 0.25;  ///< of X_TP, without the published floor
  double visible_fraction = 0;
  double confidence = 0;
  int pixels = 0;             ///< px of the last fit
  double log_likelihood = 0;  ///< nats, of the last fit
  std::vector<float> rival;   ///< how long and how much each near symmetry has been better, since it was last hidden
  int next_rival = 0;
  double seen_for = 0;    ///< s without a break
  bool by_depth = false;  ///< its colour is not to be relied on: found and followed by depth alone
  bool moving = false;
  double moving_for = 0;           ///< s since it was last seen to move; 0: moves now
  double hidden_for = 0;           ///< s without an update
  bool carried = false;            ///< it moved, or a hand touched it, when it was hidden
  int bad = 0;                     ///< frames in a row in which the image contradicts the pose
  Pose anchor = Pose::Identity();  ///< table frame; where the part was when its identity was last beyond doubt
  double calm_for = 1;             ///< s since it last moved far between two frames
  double settled_for = 0;          ///< s since it last jumped, was lost or was hidden
  std::optional<Pose> X_TP_rest;   ///< where it lay still when it was last seen well, unless it was seen to move since
  int ambiguous_with = -1;         ///< equal part it may have been taken for, of two of which one jumped lately
  double ambiguous_probability = 0;  ///< that the two are exchanged, 0..0.5
  int exchanged_with = -1;           ///< equal part it exchanged its identity with in this frame

  /// Not seen in this frame where it is believed to be.
  bool missing() const { return status != PartStatus::kTracked || bad > 0; }
  bool alive() const { return status != PartStatus::kAbsent && status != PartStatus::kLost; }
};

/// Where the part is expected after dt.
Pose PredictPose(const Track& track, double dt);

/// Whether the image agrees with a fit, in the silhouette and along its outline.
bool Believable(const PoseCandidate& candidate, const TrackOptions& options);

/// Takes a free fit into the track: fuses it with the prediction, updates velocity, covariance and whether it moves.
void Fuse(const PoseCandidate& candidate, const Pose& X_TC, double dt, const TrackOptions& options, Track& track);

/// A rigid partner says where the part is: combines it with the free pose unless the image clearly contradicts it.
/// @returns whether it was used
bool Constrain(const Pose& X_TP, const Matrix6& covariance, Track& track);

/// The part at a new place: what was believed before is dropped.
void Restart(const PoseCandidate& candidate, const Pose& X_TC, Track& track);

/// A step without evidence: the pose stays, the covariance grows.
void Coast(PartStatus status, double dt, const TrackOptions& options, Track& track);

/// Keeps book of fast moves and jumps: X_TP_before is the pose of the frame before.
void Settle(const Pose& X_TP_before, double dt, const TrackOptions& options, Track& track);

/// What the track publishes. A fit that the image contradicts, or a poor one in fast motion, is not called tracked.
PartEstimate Publish(const Track& track, const TrackOptions& options);

}  // namespace coach
