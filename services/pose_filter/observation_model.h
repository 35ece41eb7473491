// What a depth image says about a predicted surface, with the chance that something is in front of it.
//
// [Wuethrich et al. 2013]. For a pixel where a part is predicted at depth d and z is measured, with sigma(z), lambda =
// ln 2 / half_length, w the weight of a uniform tail, N the normal density and Phi its integral:
//   visible     p_v = w / z_max + (1 - w) N(z; d, sigma^2)
//   occluded    paper: p_o = w / z_max + (1 - w) (exponential with rate lambda truncated to [0, d], convolved with N)
//               full:  p_o = w / z_max + (1 - w) lambda e^(-lambda z) Phi((d - z) / sigma), not renormalised
//   background  p_b = the limit of p_o for d to infinity
// The pixel adds log(((1 - o) p_v + o p_o) / p_b); afterwards o = o p_o / ((1 - o) p_v + o p_o). In the full form a
// reading in front of the prediction (z < d - 3 sigma) adds exactly 0: a hidden pixel knows nothing. A missing reading
// adds 0 and leaves o as it is.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "services/pose_filter/depth_renderer.h"

namespace coach {

struct ObservationOptions {
  double tail_weight = 0.01;           ///< w
  double max_depth = 6;                ///< m, z_max; farther readings count as this far
  double half_length = 1;              ///< m, in which half of the rays meet an occluder
  double sigma_constant = 0.003;       ///< m
  double sigma_quadratic = 1.4247e-3;  ///< 1/m; sigma(z) = constant + quadratic z^2
};

enum class OcclusionForm { kPaper, kFull };

/// What each point's reading says before any prediction. Computed once a frame; memory only grows.
struct DepthEvidence {
  PixelGrid grid;
  int stride = 0;  ///< floats from row to row
  /// Index j * stride + i, with at least RenderedDepth::kPadding values behind the last.
  std::vector<float> z;                     ///< m; 0: no reading, or one nearer than kNearPlane
  std::vector<float> sigma, inverse_sigma;  ///< m, 1/m
  std::vector<float> occluder;            ///< (1 - w) lambda e^(-lambda z), paper form: times e^(lambda^2 sigma^2 / 2)
  std::vector<float> inverse_background;  ///< 1 / p_b

  struct Reading {
    float z = 0, sigma = 1, inverse_sigma = 1, occluder = 0, inverse_background = 1;
  };
  std::vector<Reading> table;  ///< of each raw depth
  double table_metres_per_unit = 0;
};

class ObservationModel {
 public:
  ObservationModel(const ObservationOptions& options, OcclusionForm form);

  const ObservationOptions& options() const { return options_; }
  double Sigma(double z) const { return options_.sigma_constant + options_.sigma_quadratic * z * z; }  ///< m

  /// @param depth CV_16UC1 that holds all points of the grid; empty: no readings.
  void Prepare(const cv::Mat& depth, double metres_per_unit, const PixelGrid& grid, DepthEvidence& out) const;

  /// Sum over the points of `predicted` (its area lies within the grid) of the term above, nats; within 1e-5 a point.
  /// @param occlusion o' of every point, laid out as the evidence.
  double LogLikelihood(const DepthEvidence& evidence, const RenderedDepth& predicted, const float* occlusion) const;
  /// The same with one o' for all points.
  double LogLikelihood(const DepthEvidence& evidence, const RenderedDepth& predicted, float occlusion) const;

  /// Replaces o' by o for every point of `predicted`.
  void UpdateOcclusion(const DepthEvidence& evidence, const RenderedDepth& predicted, float* occlusion) const;

 private:
  ObservationOptions options_;
  OcclusionForm form_;
};

/// How a prediction and the readings at its points compare.
struct PointCounts {
  int predicted = 0;  ///< points of the part
  int agreeing = 0;   ///< |z - d| <= 3 sigma
  int hidden = 0;     ///< z < d - 3 sigma
  int beyond = 0;     ///< z > d + 3 sigma
  int missing = 0;    ///< no reading
};
PointCounts CountPoints(const DepthEvidence& evidence, const RenderedDepth& predicted);

}  // namespace coach
