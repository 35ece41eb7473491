#include "common/bus/task_follower.h"

#include <spdlog/spdlog.h>

#include "common/assembly/task_file.h"
#include "common/configuration/task_choice.h"

namespace coach {

Task AnnouncedTask(const Station& station, const task_t& message) {
  Task task = LoadTask(TaskFileNamed(station, std::filesystem::path(message.file).stem().string()));
  if (task.sha256 != message.sha256) throw ConfigurationError(task.file.string() + " is another version of the task");
  return task;
}

TaskFollower::TaskFollower(Node& node, const Station& station, const std::string& sha256,
                           std::function<void(const Task&)> changed)
    : station_(station), sha256_(sha256), changed_(std::move(changed)) {
  node.Subscribe<task_t>([this](const task_t& message) { Follow(message); });
}

void TaskFollower::Follow(const task_t& message) {
  if (message.sha256 == sha256_ || message.sha256 == refused_) return;
  try {
    const Task task = AnnouncedTask(station_, message);
    sha256_ = task.sha256;
    refused_.clear();
    spdlog::info("task {}", task.name);
    changed_(task);
  } catch (const std::exception& e) {
    refused_ = message.sha256;
    spdlog::error("can't change to task {}: {}", message.name, e.what());
  }
}

}  // namespace coach
