// What the tracker keeps on disk, so that a tracker that was killed begins where it ended.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/assembly/part_poses.h"

namespace coach {

struct FilterState {
  std::string task_sha256;  ///< of the task file the poses belong to
  std::vector<Pose> X_CP;   ///< of every part of the task, in the camera frame of the last frame
};

/// The state after a frame; nothing if a part was never seen.
std::optional<FilterState> StateOf(const PartPoses& poses, const std::string& task_sha256);

/// Writes the file whole or not at all, even if the process is killed meanwhile. @throws std::runtime_error naming the
/// file.
void WriteState(const std::filesystem::path& file, const FilterState& state);

/// The state, if there is a file for this task; a missing, broken or foreign file is none.
std::optional<FilterState> ReadState(const std::filesystem::path& file, const std::string& task_sha256,
                                     size_t num_parts);

}  // namespace coach
