// The paper's stage 1 on colour: HSV ranges, connected regions.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/assembly/task.h"
#include "services/detector/bit_image.h"
#include "services/detector/colour_table.h"
#include "services/detector/connected_components.h"
#include "services/detector/detector.h"
#include "services/detector/white_balance.h"

namespace coach {

struct HsvDetectorOptions {
  int min_area = 40;               ///< px at 640 x 480; scaled with the image's size; smaller regions are dropped
  int max_regions_per_class = 32;  ///< the largest are kept
  int opening = 0;                 ///< px, radius; removes speckles before the regions are formed
  int closing = 1;                 ///< px, radius; joins what a line of bad pixels cuts
  double shared_colour = 0.5;  ///< a region is a candidate of each class that holds at least this share of its pixels
  int samples = 256;           ///< pixels looked at a region for its median depth and its candidate types
  /// BackgroundChromaticity of the pictures by which the HSV ranges were chosen. Given, each frame is brought back to
  /// it before its colours are looked up; empty: colours are taken as they are.
  std::optional<Chromaticity> background;
  /// Ranges in this room's light, in place of the task's: by the types' word for their colour, or by a type's name.
  std::map<std::string, HsvRange> colours;
};

/// The range by which parts of a type are found.
HsvRange RangeOf(const PartType& type, const std::map<std::string, HsvRange>& colours);

/// Pixels are classified by the HSV ranges of the task's colour classes (ColourTable). The class map shows the raw
/// classes; opening and closing act on the regions only.
class HsvDetector final : public Detector {
 public:
  /// @throws std::invalid_argument for more than 8 colour classes, a range outside OpenCV's 8-bit HSV, or an option out
  /// of its range.
  explicit HsvDetector(const Task& task, const HsvDetectorOptions& options = {});

  Detections Detect(const cv::Mat& bgr, const cv::Mat& depth, double metres_per_unit) override;

 private:
  /// What a look at some of a region's pixels tells.
  struct Sample {
    int stride = 1, skip = 0, pixels = 0;
    std::array<int, ColourTable::kMaxClasses> votes{};
    std::vector<uint16_t> depths;
  };
  void FindRegions(int colour_class, const cv::Mat& depth, double metres_per_unit, Detections& out);
  void SelectComponents(double min_area);
  void TakeSamples(const cv::Mat& depth, const Detections& detections);

  HsvDetectorOptions options_;
  int num_classes_;
  std::vector<uint32_t> types_of_class_;  ///< bit t set: type t has this class
  ColourTable table_;
  BitImage mask_, scratch_;
  ConnectedComponents components_;
  std::vector<int> kept_;       ///< components that become regions, largest first
  std::vector<int> region_of_;  ///< of each component, its place in kept_, -1: dropped
  std::vector<Sample> samples_;
};

}  // namespace coach
