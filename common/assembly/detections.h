// What stage 1 says of one frame. Plain data: the message detections_t without the bus.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/geometry/pose.h"

namespace coach {

/// One connected region of one colour class.
struct Region {
  int colour_class = 0;                ///< Task::ColourClass
  uint32_t candidate_types = 0;        ///< bit t set: part type t may look like this
  int area = 0;                        ///< px
  Eigen::Vector2f centroid{0, 0};      ///< px
  std::array<int, 4> box{0, 0, 0, 0};  ///< px; x, y, width, height
  bool touches_border = false;         ///< cut by the image
  float median_depth = 0;              ///< m; 0: no reading inside
};

struct Detections {
  int64_t utime = 0;           ///< us, of the frame
  int64_t received_utime = 0;  ///< us, wall clock at capture; 0 in lockstep
  int64_t sequence = 0;
  int width = 0, height = 0;  ///< px
  int num_classes = 0;
  std::vector<Region> regions;  ///< by class, largest first
  /// One byte a pixel, row by row: bit c set where the pixel's colour is in class c (at most 8 classes). Empty: none
  /// given.
  std::vector<uint8_t> class_map;
};

}  // namespace coach
