// Whether the camera sees the table well: light, distance, tilt. A pure function of one frame.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/imaging/frame.h"
#include "services/pose_filter/observation.h"

namespace coach {

struct CameraLimits {
  double darkest = 50, brightest = 225;    ///< median of the pixels' largest channel, 0..255
  double burnt_share = 0.15;               ///< of the pixels may be white beyond measure
  double least_depth = 0.5;                ///< share of the pixels that must have a depth reading
  double nearest = 0.40, farthest = 1.40;  ///< m along the camera's axis
  double steepest = 1.15;                  ///< rad from straight down; flatter views see only the parts' near sides
  double largest_residual = 0.008;         ///< m; more is no flat table
};

struct CameraCheck {
  double brightness = 0;       ///< median of the pixels' largest channel, 0..255
  double burnt_share = 0;      ///< pixels whose three channels are above 250
  double depth_share = 0;      ///< pixels with a depth reading
  std::optional<Plane> table;  ///< camera frame
  double table_share = 0;      ///< of the readings
  double residual = 0;         ///< m, median distance of the table's readings from the plane
  double distance = 0;         ///< m along the camera's axis to the table
  double tilt = 0;             ///< rad between the camera's axis and straight down
  /// What is wrong, worst first: no_picture, no_depth, dark, bright, no_table, uneven, near, far, flat. Empty: all
  /// well.
  std::vector<std::string> problems;
};

CameraCheck CheckCamera(const Frame& frame, const CameraLimits& limits = {});

}  // namespace coach
