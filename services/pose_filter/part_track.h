// What the filter believes of one part, and how a measurement or its absence changes it.
#pragma once

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
  double floor_position = 0.0010;  ///< m, standard deviation added to what is published
  double floor_rotation = 0.010;   ///< rad
  double hidden_growth = 0.004;    ///< m per sqrt(s): a part at rest that nothing seems to touch
  double carried_growth = 0.10;    ///< m per s: a part that was moving when it was hidden
  double least_open = 0.12;        ///< share of the silhouette that must be open for an update
  double least_agreement = 0.45;   ///< Score::agreement below which the pose is not believed
  int bad_frames = 2;              ///< in a row until the part is lost
};

struct Track {
  PartStatus status = PartStatus::kAbsent;
  Pose X_TP = Pose::Identity();
  Vector6 velocity = Vector6::Zero();               ///< table frame
  Matrix6 covariance = Matrix6::Identity() * 0.25;  ///< of X_TP, without the published floor
  double visible_fraction = 0;
  double confidence = 0;
  bool moving = false;
  double moving_for = 0;  ///< s since it was last seen to move; 0: moves now
  double hidden_for = 0;  ///< s without an update
  bool carried = false;   ///< it moved, or a hand touched it, when it was hidden
  int bad = 0;            ///< frames in a row in which the image contradicts the pose
  Matrix6 measured_information =
      Matrix6::Zero();                    ///< of the last free fit, camera frame; zero if there was none in this frame
  Pose X_CP_measured = Pose::Identity();  ///< the free fit itself

  /// Not seen in this frame where it is believed to be.
  bool missing() const { return status != PartStatus::kTracked || bad > 0; }
  bool alive() const { return status != PartStatus::kAbsent && status != PartStatus::kLost; }
};

/// Where the part is expected after dt, and how sure.
Pose PredictPose(const Track& track, double dt);
Matrix6 PredictCovariance(const Track& track, double dt, const TrackOptions& options);

/// Takes a free fit into the track: fuses it with the prediction, updates velocity, covariance and whether it moves.
void Fuse(const PoseCandidate& candidate, const Pose& X_TC, double dt, const TrackOptions& options, Track& track);

/// The part at a new place: what was believed before is dropped.
void Restart(const PoseCandidate& candidate, const Pose& X_TC, Track& track);

/// A step without evidence: the pose stays, the covariance grows.
void Coast(PartStatus status, double dt, const TrackOptions& options, Track& track);

/// What the track publishes.
PartEstimate Publish(const Track& track, const TrackOptions& options);

}  // namespace coach
