// PART_POSES as recordings of the bus hold them.
#pragma once

#include <filesystem>
#include <vector>

#include "common/assembly/part_poses.h"

namespace coach {

/// Every PART_POSES of a recording, whatever its station, in the order of time. Messages that can't be decoded are
/// left out. @throws std::runtime_error naming the file if it can't be read or holds none.
std::vector<PartPoses> ReadPartPoses(const std::filesystem::path& log);

/// Writes them as a recording that coach-replay and ReadPartPoses understand. @throws std::runtime_error naming the
/// file if it exists or can't be written.
void WritePartPoses(const std::filesystem::path& log, const std::vector<PartPoses>& poses);

}  // namespace coach
