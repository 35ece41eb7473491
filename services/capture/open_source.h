// From a source's address to the source.
#pragma once

#include <memory>

#include "services/capture/capture_options.h"
#include "services/capture/frame_source.h"

namespace coach {

/// @throws ConfigurationError if options.source has no known scheme.
void CheckSource(const CaptureOptions& options);

/// @throws SourceLost if it is a camera that is not there now, std::runtime_error if a recording can't be used.
std::unique_ptr<FrameSource> OpenSource(const CaptureOptions& options);

}  // namespace coach
