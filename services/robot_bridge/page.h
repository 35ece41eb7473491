// The virtual robot's page, built into the program from services/robot_bridge/page/.
#pragma once

#include <string_view>
#include <vector>

namespace coach {

struct PageFile {
  const char* path;  ///< as the browser asks for it
  const char* type;  ///< MIME
  std::string_view content;
};
const std::vector<PageFile>& PageFiles();

}  // namespace coach
