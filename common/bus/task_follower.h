// Keeps a service at the task that the lesson is about.
#pragma once

#include <functional>
#include <string>

#include "common/assembly/task.h"
#include "common/bus/node.h"
#include "common/configuration/station.h"

namespace coach {

/// The task that a TASK message names: the file of that name from the station's folders of tasks.
/// @throws ConfigurationError if it is missing, broken, or not the same file, byte for byte.
Task AnnouncedTask(const Station& station, const task_t& message);

/// Listens to TASK. When it names another task than the service's, loads the file of that name from the station's
/// folders of tasks, and hands it over. A file that can't be used is logged once and changes nothing.
class TaskFollower {
 public:
  /// @param sha256 of the task that the service begins with
  /// @param changed called in the node's thread
  TaskFollower(Node& node, const Station& station, const std::string& sha256, std::function<void(const Task&)> changed);

 private:
  void Follow(const task_t& message);

  Station station_;
  std::string sha256_, refused_;
  std::function<void(const Task&)> changed_;
};

}  // namespace coach
