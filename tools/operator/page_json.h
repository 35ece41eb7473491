// What the pages are sent. The front end's side of these is page/app.js.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tools/operator/annotations.h"
#include "tools/operator/command_outbox.h"
#include "tools/operator/lesson.h"

namespace coach {

/// Reads a task file for the pages; a file that can't be used becomes the view's `problem`.
std::shared_ptr<const TaskView> LoadTaskView(const std::filesystem::path& file, int64_t revision);
/// A task that can't be used, for the pages to say why.
std::shared_ptr<const TaskView> UnusableTask(const std::string& name, const std::string& sha256,
                                             const std::string& problem, int64_t revision);
std::shared_ptr<const TaskView> MakeTaskView(std::shared_ptr<const Task> task, int64_t revision);

/// What a page needs of the station file.
struct StationFacts {
  std::vector<std::string> tasks;      ///< names, to choose from
  std::vector<std::string> languages;  ///< en, el, ... to choose from
  Pose X_TR = Pose::Identity();        ///< the robot's seat
};

/// One change of everything but poses and pictures.
std::string StateJson(const Lesson::Snapshot& snapshot, const std::vector<CommandOutbox::Entry>& commands,
                      const std::vector<Annotation>& annotations, const StationFacts& facts, const std::string& station,
                      int64_t now);

/// Poses and outlines of one moment.
std::string ViewJson(const LiveView& view);

/// Services' figures in Prometheus' text format.
std::string PrometheusText(const std::vector<ServiceReport>& services, const std::string& station, int64_t now);

/// Kind of a command by the name that the page uses ("mark_done"). Empty if there is none.
std::optional<OperatorKind> OperatorKindOf(const std::string& name);
const char* NameOf(OperatorKind kind);

}  // namespace coach
