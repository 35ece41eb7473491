// What the station file says about the camera.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "common/configuration/yaml_reader.h"
#include "common/geometry/camera.h"

namespace coach {

struct CaptureOptions {
  /// openni2: (any camera), openni2:DEVICE, oni:FILE, scene:FOLDER
  std::string source = "openni2:";
  double fps = 30;                ///< Hz; of a scene folder, and asked of a camera
  int width = 640, height = 480;  ///< px; asked of a camera
  double speed = 1;               ///< of a recording, times real time
  bool lockstep = false;          ///< of a recording: each frame when the one before has been answered, none dropped
  bool loop = false;              ///< of a recording
  int64_t utime_origin = 0;       ///< us; utime of a recording's first frame
  int jpeg_quality = 95;          ///< 1..100; lowered where a frame would be too large for the bus
  std::optional<CameraModel>
      intrinsics;  ///< calibration of a camera (a scene folder has its own); else from the device's field of view
};

/// Reads the `camera` section. @param folder that relative paths in `source` start from. @throws ConfigurationError
CaptureOptions ReadCaptureOptions(const YamlNode& section, const std::filesystem::path& folder);

}  // namespace coach
