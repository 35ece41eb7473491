// Colour ranges from what the camera shows of a part. Pure functions of one frame.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "common/assembly/task.h"
#include "common/imaging/frame.h"
#include "services/pose_filter/observation.h"
#include "tools/operator/outline.h"

namespace coach {

/// Pixels of one thing: CV_8UC1, not 0 where it is.
using PixelMask = cv::Mat;

/// What hangs together with the clicked pixel: neighbours of like colour, and, where the table is known and the click
/// is above it, above the table too. Its rim (1 px) is left out: mixed colours. Empty if the click is outside the
/// image.
PixelMask ClickedRegion(const Frame& frame, const std::optional<Plane>& table, int x, int y);

/// The inside of a fitted part's silhouette, without a rim of 3 px.
PixelMask InsideOf(const std::vector<Polygon>& silhouette, const cv::Size& size);

/// Readings within 8 mm of the table.
PixelMask TablePixels(const Frame& frame, const Plane& table);

/// The range that holds nearly all of a part's pixels (the outer 0.5 % at each end are left out), with as much of a
/// margin for other light as keeps it off the background. A part without much colour (white, grey, black) is told by
/// its saturation and brightness alone.
/// @param part, background of the picture's size. Empty if `part` has under 30 pixels.
std::optional<HsvRange> SuggestRange(const cv::Mat& bgr, const PixelMask& part, const PixelMask& background);

/// Share of a mask's pixels whose colour is in a range; 0 for an empty mask.
double ShareIn(const HsvRange& range, const cv::Mat& bgr, const PixelMask& mask);

/// Whether two ranges have a colour in common.
bool Overlap(const HsvRange& a, const HsvRange& b);

}  // namespace coach
