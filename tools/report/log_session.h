// A session from recordings of the bus (coach-record's, or lcm-logger's).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/report/session.h"

namespace coach {

/// Reads the files one after the other as one session. Messages of other stations, of another version of Coach and
/// damaged ones are left out and said in Session::problems, as are files that are empty or cut off.
/// @param station empty: the one with most messages
/// @throws std::runtime_error naming a file that can't be opened
Session ReadLogSession(const std::vector<std::filesystem::path>& files, const std::string& station = "");

}  // namespace coach
