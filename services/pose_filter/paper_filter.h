// The tracker as the paper describes it, by its equations: stage 1's assignment and confidence, a Rao-Blackwellised
// particle filter in blocks, input [6], collision [5], connections on a share of the particles (IV-B4), expectation
// [3].
//
// Pseudocode of one step:
//   assign regions to parts against the previous positions; s_k by [4]; u_k = (P_k - p_k) s_k by [6]
//   parts that were never seen: plane, clusters, ICP
//   every pixel's chance of occlusion is predicted, in every particle
//   connections by [1] from the previous poses; each is enforced on its share of the particles
//   for each part: move it (and what follows it) in each particle, weight by the depth image and by [5], resample if
//     the weights have degenerated
//   occlusion is updated; the estimate is the mean, and the particles are centred about it
#pragma once

#include <optional>
#include <vector>

#include "services/pose_filter/association.h"
#include "services/pose_filter/collision.h"
#include "services/pose_filter/connection_constraint.h"
#include "services/pose_filter/depth_renderer.h"
#include "services/pose_filter/initialisation.h"
#include "services/pose_filter/observation_model.h"
#include "services/pose_filter/occlusion.h"
#include "services/pose_filter/pose_filter.h"
#include "services/pose_filter/process_model.h"
#include "services/pose_filter/random.h"

namespace coach {

/// How colour takes part: the paper's choice and the two that its section IV-C weighs against it.
enum class ColourUse {
  kInput,        ///< [6]: regions move the particles
  kObservation,  ///< (i): every predicted point's colour is observed beside its depth
  kFusedPoses,   ///< (ii): a tracker by depth and one by colour; their positions are averaged by covariance
};

struct PaperFilterOptions {
  int particles = 200;
  int step = 5;                    ///< px between the points of the image that are compared
  double resample_divergence = 2;  ///< nats, of the weights from uniform ones
  double constraint_cap = 0.6;     ///< of the particles, at most, obey a connection
  double start_interval = 0.5;     ///< s between searches for parts that were never seen
  ColourUse colour = ColourUse::kInput;
  double own_colour = 0.9;        ///< kObservation: chance that a point of the part is in its class
  double foreign_colour = 0.05;   ///< kObservation: chance that another point is
  double colour_position = 0.01;  ///< m, kFusedPoses: standard deviation of a region's position of confidence 1
  CollisionOptions collision{.allowed = 0, .allowed_connected = 0};
  ProcessOptions process;
  OcclusionChain occlusion;
  ObservationOptions observation;
  InitialisationOptions initialisation;
};

/// Knows no camera motion (X_TC is that of the start), no loss and no recovery: what the paper does not have. Status
/// and visible fraction are read off the depth image at the estimate; `pairs` and `foreign` stay empty.
class PaperFilter final : public PoseFilter {
 public:
  /// @throws std::invalid_argument if an option is out of its range or a type has no mesh.
  PaperFilter(const Task& task, const PaperFilterOptions& options, uint64_t seed);

  const PartPoses& Step(const FilterInput& input) override;
  void Reset() override;
  void Suggest(const std::vector<Pose>& X_CP) override;

 private:
  struct Shape {
    RenderMesh mesh;
    CollisionShape solid;
  };
  struct Particle {
    std::vector<MotionState> parts;    ///< about base_
    std::vector<RenderedDepth> tiles;  ///< of each part at its state
    std::vector<float> occlusion;      ///< o of each grid point
    double log_likelihood = 0;         ///< of the present image, as far as parts have been moved
    size_t links = 0;                  ///< how many of links_ it obeys
  };

  const Shape& ShapeOf(size_t part) const { return shapes_[static_cast<size_t>(task_.parts[part].type)]; }
  Pose PoseOf(const Particle& particle, size_t part) const { return Perturb(base_[part], particle.parts[part].q); }

  void TakeImage(const FilterInput& input);
  void AssociateAndSteer(const FilterInput& input);
  Vector3 SurfaceToOrigin(size_t part);
  void FindAbsentParts(const FilterInput& input);
  void Place(size_t part, const Pose& X_CP);
  void ChooseLinks();
  void MovePart(size_t part, double dt);
  double LogLikelihood(const Particle& particle);
  /// Option (i); merged_ is that of the particle.
  double ColourLogLikelihood(const Particle& particle) const;
  const RenderedDepth& Merge(const Particle& particle);
  bool AnyOverlap(const Particle& particle) const;
  void Resample();
  void Finish();
  PartPoses Output(const FilterInput& input);
  PartEstimate Describe(size_t part, const Pose& X_TC);
  /// Option (ii).
  void FuseColour(size_t part, const Pose& X_TC, PartEstimate& estimate) const;

  Task task_;
  PaperFilterOptions options_;
  uint64_t seed_;
  ObservationModel model_;
  std::vector<Shape> shapes_;  ///< one a type

  Random random_;
  std::vector<bool> known_;    ///< of each part: it has been found
  std::vector<Pose> base_;     ///< X_CP of each part, the estimate after a step
  std::vector<Vector6> rate_;  ///< mean velocity of each part, per 1/30 s
  std::vector<Particle> particles_, resampled_;
  std::vector<double> log_weights_, weights_;
  std::vector<int> parents_, first_copy_;

  CameraModel camera_;
  DepthEvidence evidence_;
  std::optional<Pose> X_TC_;
  std::vector<Pose> suggested_;
  int64_t last_utime_ = 0;
  std::optional<int64_t> last_search_;  ///< utime
  bool started_ = false;
  std::vector<RegionOfPart> regions_;
  std::vector<std::optional<Vector3>> seen_;  ///< P of each part, m, camera frame
  std::vector<uint8_t> class_map_;            ///< of the frame, for option (i); empty: none
  std::vector<RigidLink> links_;
  std::vector<RigidBodies> bodies_;  ///< for each number of links
  RenderedDepth merged_, tile_;
  PartPoses output_;
};

}  // namespace coach
