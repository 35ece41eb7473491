// The robot's seat in the station file.
#pragma once

#include <filesystem>
#include <string>

#include "common/geometry/pose.h"

namespace coach {

/// The station file's text with the section `robot` saying where the robot sits. Everything else, comments too, stays
/// as it is.
/// @param name of the file, for messages
/// @throws ConfigurationError if the section is written in braces, or what comes out does not read back as X_TR
std::string WithRobotPose(const std::string& station, const Pose& X_TR, const std::string& name);

/// Writes it to the file, whole or not at all. The old one is kept beside it.
/// @returns the old one's new name: FILE.old, or FILE.old2 and so on where that is taken
/// @throws ConfigurationError as above; std::runtime_error if a file can't be written
std::filesystem::path WriteRobotPose(const std::filesystem::path& file, const Pose& X_TR);

}  // namespace coach
