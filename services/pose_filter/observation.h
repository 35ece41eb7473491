// One frame as the filter sees it: depth with its noise, and the sets of colour classes, with the scene's other parts
// in front.
#pragma once

#include <cmath>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "common/geometry/camera.h"

namespace coach {

/// Standard deviation of a depth reading of a structured-light or time-of-flight camera, m. tracking.md's noise model,
/// after Khoshelham and Elberink, "Accuracy and Resolution of Kinect Depth Data" (Sensors 2012).
inline double DepthSigma(double z) { return 0.003 + 1.4247e-3 * z * z; }

/// n . p + d = 0, camera frame; n is unit and points from the table to the camera's side, so d > 0.
struct Plane {
  Vector3 n = -Vector3::UnitZ();
  double d = 1;
  double Height(const Vector3& p_C) const { return n.dot(p_C) + d; }  ///< m above the table
};

/// A view of one frame; owns nothing.
struct Observation {
  CameraModel camera;
  const uint16_t* depth = nullptr;  ///< row by row; null: no depth in this frame
  double metres_per_unit = 0.001;
  const uint8_t* class_map = nullptr;  ///< bit c: the colour is in class c; null: no colour in this frame

  const uint8_t* bgr = nullptr;  ///< 3 bytes a pixel, row by row; null: no colour image
  Plane table;                   ///< in this frame
  bool has_table = false;

  /// The same frame without its colours.
  Observation DepthOnly() const {
    Observation o = *this;
    o.class_map = nullptr;
    o.bgr = nullptr;
    return o;
  }

  /// Whether a reading lies on the table: the table hides nothing, so a part predicted behind it is impossible.
  bool OnTable(int x, int y, double z) const {
    if (!has_table) return false;
    const double along =
        table.n.x() * (x - camera.cx) / camera.fx + table.n.y() * (y - camera.cy) / camera.fy + table.n.z();
    return std::abs(z * along + table.d) < 0.004 + 2.5 * DepthSigma(z) * std::abs(along);
  }

  /// Depth at a pixel inside the image, m; 0: no reading.
  float Depth(int x, int y) const {
    return depth ? static_cast<float>(depth[static_cast<size_t>(y) * camera.width + x] * metres_per_unit) : 0.0f;
  }
  /// Depth that a pixel inside the image without a reading most likely has, m: that of the nearest reading to its left
  /// or right, whichever has more of its colour. 0: unknown.
  float LikelyDepth(int x, int y) const;
  /// Brightness at a pixel inside the image, 0..255; only with a colour image.
  float Grey(int x, int y) const {
    const uint8_t* p = bgr + 3 * (static_cast<size_t>(y) * camera.width + x);
    return 0.25f * static_cast<float>(p[0] + 2 * p[1] + p[2]);
  }
  uint8_t Classes(int x, int y) const { return class_map ? class_map[static_cast<size_t>(y) * camera.width + x] : 0; }
  bool Inside(int x, int y) const { return x >= 0 && y >= 0 && x < camera.width && y < camera.height; }
};

}  // namespace coach
