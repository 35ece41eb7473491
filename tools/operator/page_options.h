// The section `page` of the station file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/configuration/station.h"
#include "tools/operator/lesson.h"
#include "tools/operator/page_server.h"

namespace coach {

struct PageOptions {
  PageServer::Options server;
  Lesson::Options lesson;
  std::vector<std::string> languages{"en", "el"};  ///< that the robot can be asked to speak
  std::filesystem::path annotations;               ///< file; default: annotations.jsonl in the station's state folder
};

/// @throws ConfigurationError
PageOptions ReadPageOptions(const Station& station);

}  // namespace coach
