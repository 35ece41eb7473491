// Writes a scenario as a scene folder with ground truth (docs/formats.md).
#pragma once

#include <filesystem>
#include <functional>

#include "tools/simulator/scenario.h"

namespace coach {

struct RecordOptions {
  bool jpeg = true;
  int jpeg_quality = 92;
};

/// rgb/, depth/, scene_camera.json, scene_gt.json, scene_gt_info.json, events.json, assembly.json, task.yaml (with the
/// colour ranges that the pictures show) and models/. The same scenario gives the same bytes.
/// @param progress called after every frame with the number written.
/// @throws std::runtime_error naming what can't be written.
void RecordScene(const Scenario& scenario, const std::filesystem::path& folder, const RecordOptions& options,
                 const std::function<void(int)>& progress);

}  // namespace coach
