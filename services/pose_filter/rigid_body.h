// Parts that move as one: a connected sub-assembly, or a single part. Finds where such a body went when it moved
// farther between two frames than a refinement can follow.
#pragma once

#include <optional>
#include <vector>

#include "services/pose_filter/point_score.h"
#include "services/pose_filter/refinement.h"
#include "services/pose_filter/score.h"

namespace coach {

/// One part of the body, at a fixed pose in the body's frame G.
struct RigidMember {
  const PartModel* model = nullptr;
  const PointSet* points = nullptr;
  int part = 0;  ///< index in the owner map
  uint8_t class_bit = 0;
  Pose X_GP = Pose::Identity();
};
using RigidBody = std::vector<RigidMember>;

struct BodySearchOptions {
  double turn = 0.26;             ///< rad, spacing of the turns tried about the viewing ray and the table's normal
  int turns = 3;                  ///< to either side
  double shift_step = 8;          ///< px, spacing of the shifts tried
  double fastest = 1.6;           ///< m/s
  double slack = 0.02;            ///< m, reach beyond what the speed allows
  int points = 48;                ///< of the body, looked at for a shift
  int scored = 24;                ///< best shifts that are scored with depth
  int refined = 4;                ///< best of those that are refined
  double sure_agreement = 0.85;   ///< Score::agreement of a pose after which no other is tried
  double far = 0.08;              ///< m; a pose farther off must exceed
  double far_likelihood = 0;      ///< so many nats
  double least_agreement = 0.45;  ///< Score::agreement of a pose that is believed
  RefinementOptions refinement{.first_half_length = 14, .first_gate = 0.05};
};

/// Gauss-Newton on the body's pose with the evidence of all its members.
Pose RefineBody(const RigidBody& body, const Observation& observation, const OwnerMap& owners, const Pose& X_CG,
                const RefinementOptions& options, RefinementScratch& scratch);

/// Full observation model summed over the members; they hide each other only as far as `owners` knows them.
Score ScoreBody(const RigidBody& body, const Observation& observation, const OwnerMap& owners, const Pose& X_CG,
                RefinementScratch& scratch);

/// Where the body may have gone in dt: its colours are looked for around X_CG in the image, turned and shifted, then in
/// depth; the best are refined. Members should not be in `owners`. @returns the most likely pose, X_CG's own refinement
/// among the candidates; empty if none explains the image
/// @param normal_C of the table, camera frame
std::optional<Pose> SearchBody(const RigidBody& body, const Observation& observation, const OwnerMap& owners,
                               const Pose& X_CG, const Vector3& normal_C, double dt, const BodySearchOptions& options,
                               RefinementScratch& scratch);

}  // namespace coach
