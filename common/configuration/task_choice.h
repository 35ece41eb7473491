// The tasks that a station offers: the task files beside the station's own, and those made at this table, which are in
// the folder `tasks` of its state folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/configuration/station.h"

namespace coach {

/// Folders that are looked into, in this order; of two tasks of one name the first counts.
std::vector<std::filesystem::path> TaskFolders(const Station& station);

/// Where tasks made at this table go; empty without a state folder.
std::filesystem::path OwnTaskFolder(const Station& station);

/// Names (file names without .yaml) of all of them, sorted.
std::vector<std::string> TaskNames(const Station& station);

/// The file of one of them.
/// @throws ConfigurationError naming the folder and what is offered, if there is no such task (a name with a path in it
/// never is one).
std::filesystem::path TaskFileNamed(const Station& station, const std::string& name);

}  // namespace coach
