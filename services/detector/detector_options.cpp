#include "services/detector/detector_options.h"

namespace coach {
namespace {

std::array<int, 3> ReadBound(const YamlNode& node) {
  const auto values = node.As<std::vector<int>>();
  const auto inside = [&](size_t i, int high) { return values[i] >= 0 && values[i] <= high; };
  if (values.size() != 3 || !inside(0, 179) || !inside(1, 255) || !inside(2, 255))
    node.Fail("three whole numbers: hue 0..179, saturation and value 0..255");
  return {values[0], values[1], values[2]};
}

HsvRange ReadRange(const YamlNode& node) {
  const HsvRange range{ReadBound(node.At("low")), ReadBound(node.At("high"))};
  if (range.low[1] > range.high[1] || range.low[2] > range.high[2])
    node.Fail("low saturation and value not above the high ones (only hue wraps)");
  node.RejectUnknownKeys();
  return range;
}

}  // namespace

HsvDetectorOptions ReadDetectorOptions(const YamlNode& detector) {
  HsvDetectorOptions options;
  options.min_area = static_cast<int>(detector.GetInRange("min_area", options.min_area, 1, 100'000));
  options.opening = static_cast<int>(detector.GetInRange("opening", options.opening, 0, 10));
  options.closing = static_cast<int>(detector.GetInRange("closing", options.closing, 0, 10));
  if (const auto background = detector.Find("background")) {
    options.background =
        Chromaticity{background->GetInRange("blue_green", 0, -3, 3), background->GetInRange("red_green", 0, -3, 3)};
    background->RejectUnknownKeys();
  }
  if (const auto colours = detector.Find("colours")) {
    for (const auto& [name, range] : colours->Entries()) options.colours[name] = ReadRange(range);
  }
  detector.RejectUnknownKeys();
  return options;
}

}  // namespace coach
