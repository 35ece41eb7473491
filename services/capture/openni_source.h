// OpenNI2 cameras and their recordings.
#pragma once

#include <memory>
#include <string>

#include "services/capture/capture_options.h"
#include "services/capture/frame_source.h"

namespace coach {

/// A camera. Depth is registered to colour if the device can (else complaint() says so), mirroring is off, frames are
/// synchronised if the device can; depth and colour are paired by nearest time stamp, and the skew is in the frame.
/// @param uri of the device; empty: any. @throws SourceLost if there is none now.
std::unique_ptr<FrameSource> OpenOpenNiDevice(const std::string& uri, const CaptureOptions& options);

/// An .oni recording, each frame once, as fast as it is asked for. @throws std::runtime_error if it can't be read.
std::unique_ptr<FrameSource> OpenOniFile(const std::string& file, const CaptureOptions& options);

}  // namespace coach
