#include "common/configuration/task_choice.h"

#include <algorithm>
#include <fstream>

namespace coach {
namespace {

constexpr const char* kChoiceFile = "task";  // in the state folder

}  // namespace

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

void RememberTask(const Station& station, const std::string& name) {
  if (station.state_folder.empty()) return;
  const std::filesystem::path file = station.state_folder / kChoiceFile, fresh = file.string() + ".new";
  std::ofstream(fresh) << name << "\n";
  std::error_code error;
  std::filesystem::rename(fresh, file, error);
}

std::filesystem::path RememberedTask(const Station& station) {
  std::ifstream in(station.state_folder / kChoiceFile);
  std::string name;
  if (station.state_folder.empty() || !std::getline(in, name)) return station.task;
  const auto names = TaskNames(station);
  return std::find(names.begin(), names.end(), name) == names.end() ? station.task : TaskFileNamed(station, name);
}

}  // namespace coach
