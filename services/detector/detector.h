// Stage 1: from one colour image to the regions that may be parts. Stateless: each frame for itself.
#pragma once

#include <opencv2/core/mat.hpp>

#include "common/assembly/detections.h"

namespace coach {

/// Finds what looks like a part in one image. Implementations keep nothing from frame to frame but working memory, so
/// the same image always gives the same answer.
class Detector {
 public:
  virtual ~Detector() = default;

  /// @param bgr CV_8UC3. Anything else, or an empty image: no regions, no class map, width = height = 0.
  /// @param depth CV_16UC1 of the same size, 0 = no reading. Anything else: every median depth is 0.
  /// @param metres_per_unit of depth.
  /// @returns regions by class, largest first, and the class map; utime, received_utime and sequence are left 0.
  virtual Detections Detect(const cv::Mat& bgr, const cv::Mat& depth, double metres_per_unit) = 0;
};

}  // namespace coach
