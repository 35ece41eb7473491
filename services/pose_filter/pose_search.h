// Finds a part in an unexplained blob from nothing: orientations covering SO(3), ranked cheaply, the best refined and
// scored in full.
#pragma once

#include <algorithm>
#include <optional>

#include "services/pose_filter/blobs.h"
#include "services/pose_filter/point_score.h"
#include "services/pose_filter/refinement.h"
#include "services/pose_filter/score.h"

namespace coach {

struct PoseSearchOptions {
  int points = 80;                 ///< of the cheap score
  int refined = 8;                 ///< best candidates that are refined
  int polished = 3;                ///< best of those that are refined again, with their near symmetries
  double least_agreement = 0.6;    ///< Score::agreement of an accepted pose
  double almost_as_likely = 0.92;  ///< of the best log-likelihood: such poses are told apart by what was known before
  double least_outline = 0.72;     ///< PoseCandidate::outline_support of an accepted pose
  int least_judged = 8;            ///< outline points that must be open to judgement, if there is colour
  double largest_chi2 = 3.0;       ///< PoseEquations::depth_chi2 of an accepted pose
  bool contour = true;             ///< the outline helps to refine
  double least_visible = 0.2;      ///< share of the silhouette that must be open
};

struct PoseCandidate {
  Pose X_CP = Pose::Identity();
  Score score;
  PoseEquations evidence;
  int pixels = 0;           ///< px that agree with the pose
  double full_samples = 0;  ///< samples that the silhouette would have if nothing hid or cut it

  /// Share of the part that is seen, 0..1.
  double visible_fraction() const {
    return full_samples > 0 ? std::clamp((score.inlier + score.no_reading) / full_samples, 0.0, 1.0) : 0.0;
  }
  /// Share of the outline, where it can be judged, at which the image has the step that the pose predicts; 1 without
  /// colour.
  double outline_support() const {
    return evidence.contour_judged >= 8 ? static_cast<double>(evidence.contour_used) / evidence.contour_judged : 1.0;
  }
};

/// Whether a pose explains the image well enough to be believed without having been believed before.
bool Acceptable(const PoseCandidate& candidate, const PoseSearchOptions& options);

/// Refines a pose and scores it at the end: what every hypothesis goes through before it may win.
PoseCandidate Polish(const PartModel& model, const Observation& observation, const OwnerMap& owners, int part,
                     uint8_t class_bit, const Pose& X_CP, const RefinementOptions& options, RefinementScratch& scratch);

/// Best pose of a part at a blob, or empty if none is good enough.
/// @param former_X_CP where it was last believed: of poses that are almost equally likely the one turned least from it
/// wins; or null
/// @param X_TC for resting orientations, which are tried beside the cover of SO(3)
std::optional<PoseCandidate> SearchPose(const PartModel& model, const PointSet& points, const Observation& observation,
                                        const OwnerMap& owners, int part, uint8_t class_bit, const Blob& blob,
                                        const Pose& X_TC, const PoseSearchOptions& options, const Pose* former_X_CP,
                                        RefinementScratch& scratch);

}  // namespace coach
