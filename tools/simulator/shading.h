// Light on surfaces: the colour that a camera's pixels receive.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "tools/simulator/ray_tracer.h"
#include "tools/simulator/surface.h"

namespace coach {

struct Lighting {
  Vector3 lamp{0.6, -0.4, 1.9};        ///< m, world: the light that casts shadows
  double lamp_size = 0.25;             ///< m, half side
  Vector3 lamp_colour{1, 0.97, 0.92};  ///< irradiance at 2 m, facing it
  Vector3 window{-1, 0.3, 0.6};        ///< direction (world) of a second light without shadows
  Vector3 window_colour{0.18, 0.2, 0.24};
  Vector3 ambient{0.30, 0.31, 0.33};  ///< from above
  Vector3 ground{0.16, 0.15, 0.14};   ///< from below
};

/// A body's looks. The pattern sits in the body's frame.
struct Look {
  Material material;
  Pose X_WB = Pose::Identity();
};

/// @param looks by body.
/// @param linear CV_32FC3 blue green red; resized.
void Shade(const CameraModel& camera, const Pose& X_WC, const Hits& hits, const std::vector<float>& lit,
           const Lighting& lighting, const std::vector<Look>& looks, const std::vector<Pattern>& patterns,
           cv::Mat* linear);

}  // namespace coach
