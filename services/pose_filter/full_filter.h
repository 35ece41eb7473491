// Coach's tracker. For each part and frame: particles around motion, rest and a rigid partner, scored cheaply; the best
// refined by Gauss-Newton on depth and contour; the winner by the full observation model fused with the prediction.
// Parts that are not where they should be are searched in the blobs of colour that no part explains.
#pragma once

#include <memory>
#include <optional>
#include <random>

#include "services/pose_filter/camera_motion.h"
#include "services/pose_filter/foreign_blobs.h"
#include "services/pose_filter/pair_evidence.h"
#include "services/pose_filter/part_track.h"
#include "services/pose_filter/pose_filter.h"
#include "services/pose_filter/rigid_body.h"

namespace coach {

struct FullFilterOptions {
  int particles = 200;            ///< a part; 0: none
  int particle_points = 40;       ///< surface points a particle is scored on
  int searches = 1;               ///< searches from nothing a frame, at most (all of them in the first frames)
  bool follow_bodies = true;      ///< bodies that are not where they were predicted are looked for around there
  bool test_rivals = true;        ///< poses that look almost the same are tried
  bool follow_camera = true;      ///< the camera may move
  double link_probability = 0.6;  ///< from here on a believed connection links two parts; above 1: none does
  double link_position = 0.0015;  ///< m, play of a link
  double link_rotation = 0.015;   ///< rad
  double link_rest = 0.01;        ///< m in a frame; a partner that moved farther says nothing of an empty place
  double link_overlap = 0.012;    ///< m from the joint (a radian counting as 5 cm), up to which overlap is allowed
  double link_reach = 0.015;      ///< m, from where a partner expects a part, that costs as much as a jump
  double link_turn = 0.2;         ///< rad
  double rest_reach = 0.01;       ///< m, the same from where a covered part lay still
  double rest_turn = 0.15;        ///< rad
  double rest_left = 0.02;        ///< m (a radian counting as 5 cm), from which on it has left that place
  /// Of the likelihood, for a pose one reach (3 cm and more) or turn (0.4 rad) from the expected one; grows with the
  /// square, at most three times.
  double jump_cost = 0.03;
  double exchange_margin = 0.04;   ///< m, by which two equal parts must come a shorter way with their names exchanged
  double rival_open = 0.35;        ///< share of the silhouette that must be open for a near symmetry to be tried
  double rival_gain = 0.015;       ///< of the likelihood, by which it must be better for several frames
  double outline_cost = 0.3;       ///< of the likelihood, for a pose at whose outline the image has no edge
  double collision_cost = 0.2;     ///< of the likelihood, for a pose that lies in another part
  double allowed_overlap = 0.004;  ///< m, measured poses of touching parts overlap
  double full_overlap = 0.05;      ///< share of the surface inside the other part that costs all of it
  double follow_agreement = 0.75;  ///< of a prediction, below which the body is looked for around it
  double follow_gain = 2;          ///< by which a body must explain the image better there than at its prediction
  double least_jump_cost = 150;    ///< nats
  double relocation_gain =
      200;  ///< nats by which a part found elsewhere must explain the image better than where it was believed
  int relocation_period = 5;         ///< frames between two looks at unexplained colour while all parts are seen
  double relocation_ratio = 1.3;     ///< by which a seen part must explain the image better elsewhere
  double relocation_visible = 0.6;   ///< visible share from which on a part is left where it is; also where at least
  double relocation_small = 0.2;     ///< so much of it is seen and
  double relocation_sure = 0.8;      ///< the image agrees so well
  int surface_search_period = 5;     ///< frames between two searches of things on the table; 0: none
  double surface_own_colour = 0.35;  ///< share of a thing's pixels that must be in the part's class,
  double surface_good_colour = 0.7;  ///< from which on the part is followed by colour too
  double depth_agreement = 0.85;     ///< Score::agreement of a part that is found by depth alone
  TrackOptions track;
  PoseSearchOptions search;
  PoseSearchOptions surface_search{.refined = 16, .polished = 5, .least_outline = 0.35};
  RefinementOptions refinement;
  RefinementOptions rest_refinement{.prior_position = 0.001, .prior_rotation = 0.01};
  BodySearchOptions body;
  CameraMotionOptions camera;
  TableOptions table;
  ForeignOptions foreign;
  PairOptions pairs;
};

class FullFilter final : public PoseFilter {
 public:
  FullFilter(const Task& task, const FullFilterOptions& options, uint64_t seed);

  const PartPoses& Step(const FilterInput& input) override;
  void Reset() override;
  void Suggest(const std::vector<Pose>& X_CP) override;

 private:
  struct Shape {
    PartModel model;
    PointSet search_points;
  };
  /// A believed connection as a rigid link.
  struct Link {
    int part_a = 0, part_b = 0;
    bool known = false;  ///< its relative pose (which of the symmetric ones) was seen
    Pose X_AB = Pose::Identity();
  };
  /// What of the frame a part may be judged by.
  const Observation& ViewFor(int part, const Observation& observation) const {
    return tracks_[static_cast<size_t>(part)].by_depth ? depth_only_ : observation;
  }
  const Shape& ShapeOf(int part) const {
    return *shapes_[static_cast<size_t>(task_.parts[static_cast<size_t>(part)].type)];
  }

  void TrySuggestions(const Observation& observation);
  void LocateCamera(const Observation& observation);
  void BuildOwners(const Observation& observation, double dt);
  /// Of two equal parts of which one jumped: gives the names so that both came the shorter way from where they were
  /// beyond doubt; notes how sure that is.
  void RepairIdentities(const Observation& observation);
  /// Two equal parts swap what is believed of them; each takes the pose nearest to where it was beyond doubt.
  void Exchange(int i, int j, const Observation& observation);
  /// Tries poses that look almost the same as `best` and takes one over if it has been the better one for some frames.
  /// @param linked_X_CP where a linked partner expects the part, or null
  void TestRivals(int part, const Observation& observation, double dt, const Pose* linked_X_CP, PoseCandidate& best);
  /// What being away from the expected pose costs, nats.
  double JumpCost(const Pose& expected, double reach, double turn, const PoseCandidate& candidate) const;
  /// Equation [5] as a cost (nats) instead of a factor: measured poses of parts in contact overlap a little.
  double CollisionCost(int part, const PoseCandidate& candidate) const;
  void UpdateLinks(const FilterInput& input);
  /// Whether a pose of a part is that of its link with another one.
  bool InJoint(int part, const Pose& X_TP, int other) const;
  /// Forgets how a part is linked where a partner at rest would have it and the image shows it is not, whatever the
  /// reasoner still believes.
  void DropEmptyLinks(int part, const Observation& observation);
  std::optional<Pose> CarriedBy(int part, Matrix6& covariance) const;
  /// The best seen first: they carry those that are linked to them.
  void OrderParts();
  /// The bodies that the links make of the parts seen last, parts without links included.
  std::vector<RigidBody> Bodies() const;
  /// Looks for the bodies that are not where they were predicted and notes where their parts are now.
  void FollowBodies(const Observation& observation, double dt);
  void UpdateTrack(int part, const Observation& observation, double dt);
  std::optional<Pose> BestParticle(int part, const Observation& observation, const Pose& predicted, const Pose& rest,
                                   const Pose& refined, double dt);
  /// Over the table or beside it, at a height that a child can reach: what lies still elsewhere is no part of the
  /// lesson.
  bool InReach(const Vector3& p_T) const;
  bool Plausible(int part, const PoseCandidate& found, bool unlikely) const;
  void Recover(const Observation& observation);
  /// Where a part's colour lies unexplained while all are seen, the least visible one of that colour may be there.
  void Relocate(const std::vector<Blob>& blobs, const Observation& observation);
  /// Looks for a part that its colour did not show among the things that stand on the table.
  void FindOnTable(const Observation& observation);
  void Place(int part, const Observation& observation);
  void Output(const FilterInput& input);

  Task task_;
  FullFilterOptions options_;
  uint64_t seed_;
  std::vector<std::unique_ptr<Shape>> shapes_;  // one a type
  int num_classes_ = 0;
  std::vector<int> class_of_part_;
  std::vector<uint8_t> bit_of_part_;

  std::mt19937_64 rng_;
  int64_t last_utime_ = 0;
  int64_t steps_ = 0;
  CameraModel camera_model_;
  CameraMotion camera_;
  OwnerMap owners_;
  std::vector<Track> tracks_;
  std::vector<DepthTile> tiles_;  // of each part, as added to owners_
  std::vector<Pose> suggested_;
  std::vector<Link> links_;
  Observation depth_only_;                     // this frame without its colours
  std::vector<std::optional<Pose>> followed_;  // X_TP of parts that moved farther than predicted
  std::vector<Pose> poses_before_;
  std::vector<bool> updated_;  // parts whose pose is that of this frame
  BlobFinder blob_finder_;
  Distractors distractors_;
  TableArea area_;
  ForeignFinder foreign_;
  PairFinder pairs_;
  RefinementScratch scratch_;
  VisiblePoints particle_points_;
  std::vector<int> order_;  // parts, best seen first
  PartPoses output_;
};

}  // namespace coach
