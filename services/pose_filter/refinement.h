// A few robust Gauss-Newton steps on one part's pose: depth point-to-plane and the contour of its colour class.
//
// Depth: r = n . (q - p), p a visible surface point with normal n, q the reading at its pixel (Chen and Medioni,
// "Object modelling by registration of multiple range images", 1992). Contour: for each point of the predicted outline
// the step from inside to outside of the class is searched along the outline's normal; its mean and variance under the
// posterior over the step's place are the measurement (after Stoiber et al., "SRT3D", IJCV 2022, with class membership
// in place of histograms).
#pragma once

#include "services/pose_filter/observation.h"
#include "services/pose_filter/owner_map.h"

namespace coach {

struct RefinementOptions {
  int iterations = 4;
  int depth_points = 150;       ///< at most, of the visible surface
  int contour_points = 80;      ///< at most, of the outline; 0: it has no say
  int first_half_length = 9;    ///< px, search to either side of the outline in the first iteration
  int last_half_length = 5;     ///< px, in the last
  double first_gate = 0.030;    ///< m, depth residuals beyond are not this surface, first iteration
  double last_gate_sigmas = 3;  ///< the same in sigmas, last iteration (with a floor of 6 mm)
  double depth_witnesses = 60;  ///< neighbouring readings are not independent: they count as at most so many
  double contour_witnesses = 60;
  double outline_bias =
      -0.4;  ///< px, by which the class map's edge is expected outside the true outline: mixed pixels fall out of a
             ///< colour range, so it is negative. Estimated with the pose, as it would else tilt the part
  double outline_bias_sigma = 0.4;  ///< px, of that expectation
  double prior_position = 0.10;     ///< m, prior around the start: keeps the pose finite where nothing constrains it
  double prior_rotation = 0.6;      ///< rad
  double longest_step = 0.05;       ///< m, of the part's farthest point in one iteration
};

/// What the image says about a pose, linearised there. Information and gradient are of Perturb(X_CP, .), camera frame,
/// tempered, without any prior.
struct PoseEquations {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  int depth_used = 0;       ///< readings
  int contour_used = 0;     ///< outline points
  int contour_judged = 0;   ///< outline points where nothing hid the step, if there was one
  double outline_bias = 0;  ///< px, as estimated
  double depth_chi2 = 0;    ///< mean squared residual over sigma
};

struct RefinementResult {
  Pose X_CP = Pose::Identity();
  PoseEquations last;  ///< of the last iteration
};

/// Buffers of one call, kept by the caller so that the steady loop allocates nothing.
struct RefinementScratch {
  DepthTile tile;
  std::vector<int> visible;
  struct OutlinePoint {
    Vector3 p_P;
    Eigen::Vector2d normal;  ///< image, outward
  };
  std::vector<OutlinePoint> outline;
};

RefinementResult Refine(const PartModel& model, const Observation& observation, const OwnerMap& owners, int part,
                        uint8_t class_bit, const Pose& X_CP, const RefinementOptions& options,
                        RefinementScratch& scratch);

/// The pieces of a refinement, for those that join several parts into one body.
/// Renders the part and picks its visible surface points and its outline into `scratch`. @returns false outside the
/// image
bool FindEvidence(const PartModel& model, const Observation& observation, const Pose& X_CP,
                  const RefinementOptions& options, RefinementScratch& scratch);
/// @param blend 0: gates of the first iteration, 1: of the last
/// @param outline_bias px, as estimated last
PoseEquations Linearise(const PartModel& model, const Observation& observation, const OwnerMap& owners, int part,
                        uint8_t class_bit, const Pose& X_CP, double blend, double outline_bias,
                        const RefinementOptions& options, const RefinementScratch& scratch);
/// Solution of the equations with the prior, no longer than allowed; zero if there is none.
/// @param to_start from the pose of the equations to the prior's mean
/// @param reach m, from the body's origin to its farthest point
Vector6 RefinementStep(const PoseEquations& equations, const Vector6& to_start, double reach,
                       const RefinementOptions& options);
/// How far a step moves the body's farthest point, m, at most.
inline double StepLength(const Vector6& step, double reach) {
  return step.head<3>().norm() + reach * step.tail<3>().norm();
}

/// Points of the outer outline at a pose, evenly spread over its length; hidden ones are left out.
void FindOutline(const PartModel& model, const CameraModel& camera, const Pose& X_CP, const DepthTile& tile, int points,
                 std::vector<RefinementScratch::OutlinePoint>& outline);

}  // namespace coach
