#include "common/configuration/task_choice.h"

#include <algorithm>
#include <set>

namespace coach {

std::filesystem::path OwnTaskFolder(const Station& station) {
  return station.state_folder.empty() ? std::filesystem::path() : station.state_folder / "tasks";
}

std::vector<std::filesystem::path> TaskFolders(const Station& station) {
  std::vector<std::filesystem::path> folders;
  if (!station.task.empty()) folders.push_back(station.task.parent_path());
  const auto own = OwnTaskFolder(station);
  if (!own.empty() && (folders.empty() || own.lexically_normal() != folders[0].lexically_normal()))
    folders.push_back(own);
  return folders;
}

std::vector<std::string> TaskNames(const Station& station) {
  std::set<std::string> names;
  std::error_code error;
  for (const auto& folder : TaskFolders(station)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      if (entry.path().extension() == ".yaml" && entry.is_regular_file(error)) names.insert(entry.path().stem());
    }
  }
  return {names.begin(), names.end()};
}

std::filesystem::path TaskFileNamed(const Station& station, const std::string& name) {
  const auto names = TaskNames(station);
  const auto folders = TaskFolders(station);
  if (std::find(names.begin(), names.end(), name) != names.end()) {
    for (const auto& folder : folders) {
      if (std::filesystem::is_regular_file(folder / (name + ".yaml"))) return folder / (name + ".yaml");
    }
  }
  std::string offered;
  for (const auto& known : names) offered += (offered.empty() ? "" : ", ") + known;
  const std::string where = folders.empty() ? "any folder" : folders[0].string();
  throw ConfigurationError("there is no task '" + name + "' in " + where + ", only " +
                           (offered.empty() ? "none" : offered));
}

}  // namespace coach
