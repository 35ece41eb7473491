// The tasks that a station offers: the task files beside the station's own.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/configuration/station.h"

namespace coach {

/// Names (file names without .yaml) of the task files in the folder of the station's task, sorted. Empty without one.
std::vector<std::string> TaskNames(const Station& station);

/// The file that an operator's command CHOOSE_TASK names.
/// @throws ConfigurationError naming the folder and what is offered, if there is no such task (a name with a path in it
/// never is one).
std::filesystem::path TaskFileNamed(const Station& station, const std::string& name);

/// Keeps the operator's choice in the station's state folder, for services that start later. Without a folder, or if it
/// can't be written, nothing is kept.
void RememberTask(const Station& station, const std::string& name);

/// The task that was remembered; the station's own if none was or it is gone.
std::filesystem::path RememberedTask(const Station& station);

}  // namespace coach
