#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "common/assembly/task_file.h"
#include "common/bus/command_signature.h"
#include "common/bus/service_main.h"
#include "common/configuration/task_choice.h"
#include "services/assembly_reasoner/assembly_reasoner_service.h"
#include "services/assembly_reasoner/lesson_configuration.h"

namespace {

using namespace coach;

/// Tasks of the station's folder that nobody asked for by name: one that can't be used is left out.
void AddTasksBeside(const Station& station, std::vector<Task>& tasks) {
  for (const auto& name : TaskNames(station)) try {
      Task task = LoadTask(TaskFileNamed(station, name), {.read_meshes = false});
      const bool known = std::any_of(tasks.begin(), tasks.end(), [&](const Task& t) { return t.name == task.name; });
      if (!known) tasks.push_back(std::move(task));
    } catch (const std::exception& e) {
      spdlog::warn("left out: {}", e.what());
    }
}

/// The station's task first, then those of the lesson; a file given twice counts once.
std::vector<Task> LoadTasks(const Station& station, const LessonConfiguration& configuration) {
  std::vector<Task> tasks;
  std::vector<std::filesystem::path> files = configuration.tasks;
  if (!station.task.empty()) files.insert(files.begin(), station.task);
  if (files.empty()) throw ConfigurationError("no task: give --task FILE, or `task:` in the station file");
  for (const auto& file : files) {
    Task task = LoadTask(file, {.read_meshes = false});
    bool known = false;
    for (const Task& other : tasks) {
      if (other.name == task.name && other.file != task.file)
        throw ConfigurationError(file.string() + ": name: found '" + task.name + "', expected a name that " +
                                 other.file.string() + " does not use");
      known |= other.name == task.name;
    }
    if (!known) tasks.push_back(std::move(task));
  }
  return tasks;
}

}  // namespace

int main(int argc, char** argv) {
  std::string phrases;
  bool paper = false, start = false;
  return ServiceMain(
      argc, argv, "assembly-reasoner",
      "Coach's assembly reasoner: decides which connections are made and what the robot says about it.",
      [&](CLI::App& app) {
        app.add_option("--phrases", phrases, "folder of phrase files instead of the station file's");
        app.add_flag("--paper", paper, "the paper's connection model [1]-[2]");
        app.add_flag("--start", start, "the lesson begins with the first poses, not with the operator's word");
      },
      [&](ServiceContext& context) {
        const Station& station = context.station;
        LessonConfiguration configuration =
            ReadLessonConfiguration(station.Section("guidance"), station.file.parent_path());
        if (!phrases.empty()) configuration.phrases = phrases;
        if (configuration.phrases.empty()) configuration.phrases = ShippedPhrases();
        configuration.options.reasoner.paper |= paper;
        configuration.options.start_by_itself |= start;
        auto books = LoadPhraseBooks(configuration.phrases);
        if (!books.contains(configuration.options.language))
          throw ConfigurationError("guidance: language: found '" + configuration.options.language +
                                   "', expected one of the phrase files in " + configuration.phrases.string());
        std::vector<Task> tasks = LoadTasks(station, configuration);
        configuration.options.in_a_row = static_cast<int>(tasks.size());
        AddTasksBeside(station, tasks);
        Lesson lesson(std::move(tasks), std::move(books), configuration.options, context.node.station);
        context.node.expects_frames = true;
        Node node(context.node);
        ReasonerServiceOptions options;
        if (!node.lockstep()) options.robot_url = station.robot_url;
        options.key = ReadKey(station.key_file);
        options.event_log = configuration.event_log;
        if (!station.state_folder.empty() && !node.lockstep()) {
          options.state_file = station.state_folder / "assembly-reasoner.json";
          if (options.event_log.empty()) options.event_log = station.state_folder / "events.jsonl";
        }
        AssemblyReasonerService(node, lesson, options).Run();
      });
}
