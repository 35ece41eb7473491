// One RGB-D frame in memory.
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "common/geometry/camera.h"

namespace coach {

/// Colour and depth of one moment, registered to each other. Either image may be empty (a camera without it, or lost on
/// the way).
struct Frame {
  int64_t utime = 0;               ///< us, time of the data
  int64_t received_utime = 0;      ///< us since 1970, wall clock at capture; 0 in lockstep
  int64_t sequence = 0;            ///< frames of this source, from 0
  CameraModel camera;              ///< of both images
  cv::Mat colour;                  ///< CV_8UC3, blue green red (OpenCV's order)
  cv::Mat depth;                   ///< CV_16UC1; 0: no reading
  double metres_per_unit = 0.001;  ///< of depth
  int exposure_skew_us = 0;        ///< colour exposure minus depth exposure
};

}  // namespace coach
