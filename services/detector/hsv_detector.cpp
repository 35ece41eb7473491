#include "services/detector/hsv_detector.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

namespace coach {
namespace {

std::vector<HsvRange> ClassRanges(const Task& task, const std::map<std::string, HsvRange>& colours) {
  std::vector<HsvRange> ranges(static_cast<size_t>(task.NumColourClasses()));
  for (size_t t = 0; t < task.types.size(); ++t) {
    ranges[static_cast<size_t>(task.ColourClass(static_cast<int>(t)))] = RangeOf(task.types[t], colours);
  }
  return ranges;
}

void Check(const HsvDetectorOptions& options) {
  const auto need = [](bool ok, const char* what) {
    if (!ok) throw std::invalid_argument(std::string("detector options: ") + what);
  };
  need(options.min_area >= 1, "min_area must be at least 1 px");
  need(options.max_regions_per_class >= 1 && options.max_regions_per_class <= 1000,
       "max_regions_per_class must be in 1..1000");
  need(options.opening >= 0 && options.opening <= 20, "opening must be in 0..20 px");
  need(options.closing >= 0 && options.closing <= 20, "closing must be in 0..20 px");
  need(options.shared_colour > 0 && options.shared_colour <= 1, "shared_colour must be in (0, 1]");
  need(options.samples >= 1, "samples must be at least 1");
}

}  // namespace

HsvRange RangeOf(const PartType& type, const std::map<std::string, HsvRange>& colours) {
  for (const std::string& name : {type.name, type.colour}) {
    if (const auto found = colours.find(name); found != colours.end()) return found->second;
  }
  return type.hsv;
}

HsvDetector::HsvDetector(const Task& task, const HsvDetectorOptions& options)
    : options_(options), num_classes_(task.NumColourClasses()), table_(ClassRanges(task, options.colours)) {
  Check(options);
  if (task.types.size() > 32) throw std::invalid_argument("at most 32 part types are possible");
  types_of_class_.resize(static_cast<size_t>(num_classes_));
  for (size_t t = 0; t < task.types.size(); ++t) {
    types_of_class_[static_cast<size_t>(task.ColourClass(static_cast<int>(t)))] |= uint32_t{1} << t;
  }
}

Detections HsvDetector::Detect(const cv::Mat& bgr, const cv::Mat& depth, double metres_per_unit) {
  Detections out;
  out.num_classes = num_classes_;
  if (bgr.empty() || bgr.type() != CV_8UC3) return out;
  out.width = bgr.cols;
  out.height = bgr.rows;
  out.class_map.resize(bgr.total());
  ChannelGains gains{1, 1, 1};
  if (options_.background) {
    if (const auto seen = BackgroundChromaticity(bgr)) gains = BalancingGains(*options_.background, *seen);
  }
  table_.Classify(bgr, gains, out.class_map.data());
  const bool depth_usable = depth.type() == CV_16UC1 && depth.size() == bgr.size();
  for (int c = 0; c < num_classes_; ++c) FindRegions(c, depth_usable ? depth : cv::Mat(), metres_per_unit, out);
  return out;
}

void HsvDetector::FindRegions(int colour_class, const cv::Mat& depth, double metres_per_unit, Detections& out) {
  ExtractBit(out.class_map.data(), out.width, out.height, colour_class, mask_);
  Open(options_.opening, mask_, scratch_);
  Close(options_.closing, mask_, scratch_);
  components_.Find(mask_);

  const double scale = static_cast<double>(out.width) * out.height / (640.0 * 480.0);
  SelectComponents(std::max(1.0, options_.min_area * scale));
  TakeSamples(depth, out);
  for (size_t i = 0; i < kept_.size(); ++i) {
    const Component& c = components_.components()[static_cast<size_t>(kept_[i])];
    Sample& sample = samples_[i];
    Region region;
    region.colour_class = colour_class;
    for (int k = 0; k < num_classes_; ++k) {
      if (k == colour_class || sample.votes[static_cast<size_t>(k)] >= options_.shared_colour * sample.pixels) {
        region.candidate_types |= types_of_class_[static_cast<size_t>(k)];
      }
    }
    region.area = c.area;
    region.centroid = {static_cast<float>(c.centroid[0]), static_cast<float>(c.centroid[1])};
    region.box = c.box;
    region.touches_border =
        c.box[0] == 0 || c.box[1] == 0 || c.box[0] + c.box[2] == out.width || c.box[1] + c.box[3] == out.height;
    if (!sample.depths.empty()) {
      const auto middle = sample.depths.begin() + static_cast<ptrdiff_t>(sample.depths.size() / 2);
      std::nth_element(sample.depths.begin(), middle, sample.depths.end());
      region.median_depth = static_cast<float>(*middle * metres_per_unit);
    }
    out.regions.push_back(region);
  }
}

void HsvDetector::SelectComponents(double min_area) {
  const auto& found = components_.components();
  const auto area = [&](int i) { return found[static_cast<size_t>(i)].area; };
  kept_.clear();
  for (int i = 0; i < static_cast<int>(found.size()); ++i) {
    if (area(i) >= min_area) kept_.push_back(i);
  }
  std::sort(kept_.begin(), kept_.end(), [&](int a, int b) { return std::pair(area(b), a) < std::pair(area(a), b); });
  if (kept_.size() > static_cast<size_t>(options_.max_regions_per_class)) {
    kept_.resize(static_cast<size_t>(options_.max_regions_per_class));
  }
  region_of_.assign(found.size(), -1);
  if (samples_.size() < kept_.size()) samples_.resize(kept_.size());
  for (size_t i = 0; i < kept_.size(); ++i) {
    region_of_[static_cast<size_t>(kept_[i])] = static_cast<int>(i);
    Sample& sample = samples_[i];
    sample.stride = area(kept_[i]) / options_.samples | 1;  // odd: does not lock onto columns
    sample.skip = sample.stride / 2;
    sample.pixels = 0;
    sample.votes.fill(0);
    sample.depths.clear();
  }
}

void HsvDetector::TakeSamples(const cv::Mat& depth, const Detections& detections) {
  for (const PixelRun& run : components_.runs()) {
    const int region = region_of_[static_cast<size_t>(run.component)];
    if (region < 0) continue;
    Sample& sample = samples_[static_cast<size_t>(region)];
    int x = run.begin + sample.skip;
    for (; x < run.end; x += sample.stride) {
      const size_t pixel = static_cast<size_t>(run.y) * static_cast<size_t>(detections.width) + static_cast<size_t>(x);
      const uint8_t classes = detections.class_map[pixel];
      for (int c = 0; c < num_classes_; ++c) sample.votes[static_cast<size_t>(c)] += classes >> c & 1;
      ++sample.pixels;
      if (depth.empty()) continue;
      if (const uint16_t d = depth.at<uint16_t>(run.y, x); d != 0) sample.depths.push_back(d);
    }
    sample.skip = x - run.end;
  }
}

}  // namespace coach
