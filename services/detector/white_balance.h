// Undoes the drift of a camera's white balance by the colour of what fills most of the picture.
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "services/detector/colour_table.h"

namespace coach {

/// Colour without brightness: natural logarithms of ratios of 8-bit levels.
struct Chromaticity {
  double blue_green = 0;  ///< ln(blue / green)
  double red_green = 0;   ///< ln(red / green)
};

/// The chromaticity most of the picture has (the table, the wall): the peak of the histogram of every eighth pixel,
/// each way. Pixels too dark or saturated don't count. Empty if no colour is common enough (5 % of the pixels).
/// @param bgr CV_8UC3.
std::optional<Chromaticity> BackgroundChromaticity(const cv::Mat& bgr);

/// Gains that turn `seen` into `reference`. A shift of more than 0.4 is another background and not the camera: no
/// gains.
ChannelGains BalancingGains(const Chromaticity& reference, const Chromaticity& seen);

}  // namespace coach
