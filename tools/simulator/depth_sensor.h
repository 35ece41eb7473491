// Models of two kinds of depth camera.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "tools/simulator/noise.h"
#include "tools/simulator/ray_tracer.h"
#include "tools/simulator/surface.h"

namespace coach {

struct DepthSensorOptions {
  enum class Kind {
    kStructuredLight,  ///< Kinect v1, Xtion: quantised disparity, projector shadow, ragged edges, holes
    kTimeOfFlight,     ///< Kinect v2, Azure: no shadow, noise of low reflectance, flying pixels at edges
    kPerfect
  };
  Kind kind = Kind::kStructuredLight;
  double noise = 1;                     ///< factor on every random error
  double projector_baseline = 0.075;    ///< m, projector right of the infrared camera
  double colour_baseline = 0.025;       ///< m, infrared camera left of the colour camera
  double infrared_focal = 580;          ///< px at 640 px width
  double disparity_step = 1.0 / 8;      ///< px
  double disparity_noise = 0.11;        ///< px, standard deviation
  double edge_noise = 0.6;              ///< px, standard deviation of the wobble of edges
  double nearest = 0.45, farthest = 6;  ///< m
};

/// Turns what an ideal camera sees into a depth image registered to colour, in mm.
class DepthSensor {
 public:
  DepthSensor(const DepthSensorOptions& options, const CameraModel& colour, Random& random);

  /// The camera whose hits Measure takes.
  const CameraModel& camera() const { return infrared_; }
  /// Its pose in the colour camera.
  Pose X_CI() const;

  /// @param R_WI orientation of the infrared camera in the world, in which the hits' normals are.
  /// @param holes for each body: share of its area without a reading.
  /// @returns CV_16UC1, mm, 0: no reading; pixels of the colour camera.
  cv::Mat Measure(const Hits& hits, const Matrix3& R_WI, const std::vector<double>& holes, Random& random);

 private:
  void StructuredLight(const Hits& hits, const Matrix3& R_WI, const std::vector<double>& holes, Random& random);
  void TimeOfFlight(const Hits& hits, const Matrix3& R_WI, const std::vector<double>& holes, Random& random);
  void MarkEdges(const Hits& hits);
  void MarkShadows(const Hits& hits);
  cv::Mat Register() const;

  DepthSensorOptions options_;
  CameraModel colour_, infrared_;
  NoiseTable table_;
  SmoothNoise coarse_, wobble_x_, wobble_y_, hole_field_;
  std::vector<float> measured_;           // m, 0: none; infrared image
  std::vector<uint8_t> shadow_;           // 1: not lit by the projector
  std::vector<uint8_t> edge_;             // 1: beside a jump of depth
  std::vector<float> nearest_of_column_;  // disparity by projector column
  std::vector<float> rows_;               // of the noise fields
};

}  // namespace coach
