// Reads a task file (docs/formats.md): part types, slots, connections, mistakes, steps, variants.
//
// Checked: keys and types of values; names (letters, digits, - and _; no two alike); slots and types that are named
// exist; enough parts for the slots; rotations are rotations; colour ranges; every ring of connections closes, modulo
// the parts' symmetries; steps name connections of the task, once each.
#pragma once

#include <filesystem>

#include "common/assembly/task.h"

namespace coach {

struct TaskFileOptions {
  double ring_position_tolerance = 0.001;  ///< m, by which the poses round a ring may miss the identity
  double ring_angle_tolerance = 0.02;      ///< rad
  bool read_meshes = true;                 ///< false: only that the files exist is checked
};

/// @throws ConfigurationError "file:line: key: found X, expected Y"
Task LoadTask(const std::filesystem::path& file, const TaskFileOptions& options = {});

}  // namespace coach
