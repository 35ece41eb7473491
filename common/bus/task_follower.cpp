#include "common/bus/task_follower.h"

#include <spdlog/spdlog.h>

#include "common/assembly/task_file.h"
#include "common/configuration/task_choice.h"

namespace coach {

TaskFollower::TaskFollower(Node& node, const Station& station, const std::string& sha256,
                           std::function<void(const Task&)> changed)
    : station_(station), sha256_(sha256), changed_(std::move(changed)) {
  node.Subscribe<task_t>([this](const task_t& message) { Follow(message); });
}

void TaskFollower::Follow(const task_t& message) {
  if (message.sha256 == sha256_ || message.sha256 == refused_) return;
  std::string why = "its file is another version";
  try {
    const Task task = LoadTask(TaskFileNamed(station_, std::filesystem::path(message.file).stem().string()));
    if (task.sha256 == message.sha256) {
      sha256_ = task.sha256;
      refused_.clear();
      spdlog::info("task {}", task.name);
      return changed_(task);
    }
  } catch (const std::exception& e) {
    why = e.what();
  }
  refused_ = message.sha256;
  spdlog::error("can't change to task {}: {}", message.name, why);
}

}  // namespace coach
