// Images between memory and bus.
#pragma once

#include "common/bus/channels.h"
#include "common/imaging/frame.h"
#include "common/imaging/image_codec.h"

namespace coach {

intrinsics_t ToMessage(const CameraModel& camera);
/// @throws std::invalid_argument if the camera is not usable (CameraModel::Problem) or larger than kMaxImageSide.
CameraModel FromMessage(const intrinsics_t& message);

/// The frame's colour image (CV_8UC3 of the camera's size). @throws std::invalid_argument for another.
color_image_t ToColourMessage(const Frame& frame, ColourEncoding encoding, int jpeg_quality);
/// The frame's depth image (CV_16UC1 of the camera's size). @throws std::invalid_argument for another.
depth_image_t ToDepthMessage(const Frame& frame, DepthEncoding encoding);

/// Decodes the image and everything that comes with it into a frame whose other image is empty.
/// @throws std::invalid_argument saying why the message holds no such image.
Frame FromMessage(const color_image_t& message);
Frame FromMessage(const depth_image_t& message);

}  // namespace coach
