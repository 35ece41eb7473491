#include "common/configuration/task_choice.h"

#include <algorithm>

namespace coach {
std::vector<std::string> TaskNames(const Station& station) {
  std::vector<std::string> names;
  if (station.task.empty()) return names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(station.task.parent_path(), error)) {
    if (entry.path().extension() == ".yaml" && entry.is_regular_file(error)) names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::filesystem::path TaskFileNamed(const Station& station, const std::string& name) {
  const auto names = TaskNames(station);
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    return station.task.parent_path() / (name + ".yaml");
  }
  std::string offered;
  for (const auto& known : names) offered += (offered.empty() ? "" : ", ") + known;
  throw ConfigurationError("there is no task '" + name + "' in " + station.task.parent_path().string() + ", only " +
                           (offered.empty() ? "none" : offered));
}

}  // namespace coach
