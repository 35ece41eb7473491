// Pinhole camera with OpenCV's distortion model.
#pragma once

#include <array>
#include <string>

#include "common/geometry/pose.h"

namespace coach {

/// Pixel centres are at integer coordinates: the upper left pixel's centre is (0, 0).
struct CameraModel {
  int width = 0;                       ///< px
  int height = 0;                      ///< px
  double fx = 0;                       ///< px
  double fy = 0;                       ///< px
  double cx = 0;                       ///< px
  double cy = 0;                       ///< px
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3; all 0: rectified

  bool operator==(const CameraModel&) const = default;

  bool distorted() const;

  /// Pixel of a point in front of the camera (z > 0), with distortion.
  Eigen::Vector2d Project(const Vector3& p_C) const;

  /// Point at depth z (along the optical axis, m) seen at a pixel. Distortion is undone by fixed-point iteration (1e-9
  /// px for lenses of ordinary strength).
  Vector3 BackProject(const Eigen::Vector2d& pixel, double z) const;

  /// Empty if usable, else what is wrong: sizes and focal lengths must be positive and finite, the principal point
  /// within one image size of the image.
  std::string Problem() const;
};

}  // namespace coach
