// The ground truth of a scene as files: scene_gt.json, scene_gt_info.json, events.json, assembly.json, task.yaml,
// models/.
#pragma once

#include <filesystem>
#include <vector>

#include "tools/simulator/colour_ranges.h"
#include "tools/simulator/scenario.h"

namespace coach {

/// Every function throws std::runtime_error naming the file that can't be written.
void WriteTruth(const std::filesystem::path& folder, const Scenario& scenario, const std::vector<FrameTruth>& frames);
void WriteEvents(const std::filesystem::path& folder, const Scenario& scenario, const std::vector<FrameTruth>& frames);
void WriteAssembly(const std::filesystem::path& folder, const Scenario& scenario, const std::vector<HsvRange>& ranges);
void WriteTask(const std::filesystem::path& folder, const Task& task, const std::vector<HsvRange>& ranges);
void WriteModels(const std::filesystem::path& folder, const Task& task);

/// What the pictures show of the parts: occlusion_start, occlusion_end, out_of_view, in_view, in order of time.
std::vector<TrueEvent> SightEvents(const Scenario& scenario, const std::vector<FrameTruth>& frames);

}  // namespace coach
