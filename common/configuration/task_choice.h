// The tasks that a station offers: the task files beside the station's own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/configuration/station.h"

namespace coach {

/// Names (file names without .yaml) of the task files in the folder of the station's task, sorted. Empty without one.
std::vector<std::string> TaskNames(const Station& station);

/// The file of one of them.
/// @throws ConfigurationError naming the folder and what is offered, if there is no such task (a name with a path in it
/// never is one).
std::filesystem::path TaskFileNamed(const Station& station, const std::string& name);

}  // namespace coach
