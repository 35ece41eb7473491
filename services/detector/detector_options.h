// The `detector:` part of the station file.
#pragma once

#include "common/configuration/yaml_reader.h"
#include "services/detector/hsv_detector.h"

namespace coach {

/// Reads the options; it may be an empty map (all defaults).
/// @throws ConfigurationError naming file, line, key, what was found and expected.
HsvDetectorOptions ReadDetectorOptions(const YamlNode& detector);

}  // namespace coach
