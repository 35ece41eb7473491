// A small recorded scene for tests of processes: a blue box slides over a table.
#pragma once

#include <filesystem>

namespace coach {

/// 160 x 120 px, task.yaml with one part, so many frames for 30 Hz.
void WriteTinyScene(const std::filesystem::path& folder, int frames);

}  // namespace coach
