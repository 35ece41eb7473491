// Colour ranges as a careful teacher would set them: from what the camera shows of each part.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

#include "common/assembly/task.h"

namespace coach {

/// Collects the colours of parts over the frames of a scene.
class ColourRanges {
 public:
  explicit ColourRanges(const Task& task);
  /// @param part_at CV_8UC1: 1 + part of each pixel; pixels next to another surface don't count.
  void Add(const cv::Mat& colour, const cv::Mat& part_at);
  /// A range for every part type: 99 % of its pixels, and a margin. Types that were never seen keep the task's range.
  std::vector<HsvRange> Ranges() const;

 private:
  const Task& task_;
  std::vector<std::vector<int>> hue_, saturation_, value_;  // by type: histograms
};

}  // namespace coach
