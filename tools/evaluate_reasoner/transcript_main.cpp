// coach-lesson-transcript: a simulated lesson as a teacher would read it, in every language, as Markdown.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "common/assembly/task_file.h"
#include "services/assembly_reasoner/lesson_configuration.h"
#include "tools/evaluate_reasoner/pose_script.h"

namespace {

using namespace coach;
using Kind = ScriptAction::Kind;

/// A child that thinks for long, errs twice, misses narrowly, and ends well.
std::vector<ScriptAction> HesitantChild(const Task& task) {
  std::vector<ScriptAction> script;
  const auto add = [&](Kind kind, int index, int a, int b, double pause, double gap = 0) {
    ScriptAction action{kind, index, a, b};
    action.pause = pause;
    action.gap = gap;
    script.push_back(action);
  };
  std::vector<int> part_in_slot(task.slots.size(), -1);
  std::vector<bool> used(task.parts.size(), false);
  for (size_t s = 0; s < task.slots.size(); ++s) {
    for (size_t p = 0; p < task.parts.size() && part_in_slot[s] < 0; ++p) {
      if (used[p] || task.parts[p].type != task.slots[s].type) continue;
      part_in_slot[s] = static_cast<int>(p);
      used[p] = true;
    }
  }
  const auto first = [&](const std::vector<int>& types) {
    std::vector<int> out;
    for (const int type : types) {
      int p = 0;
      while (task.parts[p].type != type || (!out.empty() && out[0] == p)) ++p;
      out.push_back(p);
    }
    return out;
  };
  if (!task.mistakes.empty()) {
    const Mistake& m = task.mistakes[0];
    const auto parts = first({m.type_a, m.type_b});
    add(Kind::kMistake, 0, parts[0], parts[1], 55);
    add(Kind::kUndo, 0, parts[0], parts[1], 14);
  }
  bool missed = false;
  for (const ScriptAction& step : PlainScript(task, task.variants[0], part_in_slot)) {
    if (!missed && !script.empty()) add(Kind::kNearMiss, step.index, step.part_a, step.part_b, 8, 0.012);
    missed = true;
    add(Kind::kConnect, step.index, step.part_a, step.part_b, script.size() % 2 == 0 ? 6 : 20);
  }
  return script;
}

std::string Clock(int64_t utime) {
  char text[16];
  const int s = static_cast<int>(utime / 1000000);
  std::snprintf(text, sizeof text, "%d:%02d", s / 60, s % 60);
  return text;
}

void Print(const Task& task, const std::map<std::string, PhraseBook>& books, const std::string& language, bool group) {
  LessonOptions options;
  options.language = language;
  options.group = group;
  options.start_by_itself = true;
  Lesson lesson({task}, books, options, "CLASS");
  const ScriptedLesson script = PlayScript(task, HesitantChild(task), {}, 15, 3);
  std::printf("\n## %s, %s, %s\n\n| time | what happens | the robot says | and does |\n|---|---|---|---|\n",
              task.name.c_str(), language.c_str(), group ? "a group" : "one child");
  const int64_t start = script.frames.front().utime;
  int64_t robot_until = 0, robot_id = 0;
  for (const PartPoses& poses : script.frames) {
    if (robot_id != 0 && poses.utime >= robot_until) {
      RobotStatus status;
      status.session = lesson.session();
      status.command_id = robot_id;
      status.state = ActState::kDone;
      lesson.Handle(status);
      robot_id = 0;
    }
    const LessonOutput out = lesson.Step(poses);
    for (const GuidanceEvent& e : out.events) {
      const bool shown = e.kind == "connect" || e.kind == "wrong" || e.kind == "disconnect" || e.kind == "repair";
      if (shown)
        std::printf("| %s | *%s %s* (%s and %s) | | |\n", Clock(e.since - start).c_str(), e.kind.c_str(),
                    e.subject.c_str(), task.parts[e.part_a].name.c_str(), task.parts[e.part_b].name.c_str());
    }
    for (const RobotCommand& c : out.commands) {
      if (c.kind != ActKind::kAct) continue;
      std::string does = c.point_target ? "points, " : "";
      if (c.look_target) does += "looks, ";
      if (!c.eye_colour.empty()) does += c.eye_colour + " eyes";
      std::printf("| %s | %s | %s | %s |\n", Clock(poses.utime - start).c_str(), c.phrase_key.c_str(), c.text.c_str(),
                  does.c_str());
      robot_id = c.id;
      robot_until = poses.utime + static_cast<int64_t>((0.5 + CountCharacters(c.text) / 14.0) * 1e6);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Prints simulated lessons in every language");
  std::vector<std::string> tasks;
  std::string phrases;
  app.add_option("tasks", tasks, "task files")->required()->check(CLI::ExistingFile);
  app.add_option("--phrases", phrases, "folder of phrase files instead of the shipped ones");
  CLI11_PARSE(app, argc, argv);
  try {
    const auto books = LoadPhraseBooks(phrases.empty() ? ShippedPhrases() : std::filesystem::path(phrases));
    std::printf(
        "# Simulated lessons\n\nMade by `coach-lesson-transcript`. The child thinks for long, joins two pieces "
        "that do not belong together, misses narrowly, and ends well.\n");
    for (const std::string& file : tasks) {
      const Task task = LoadTask(file);
      for (const auto& [language, book] : books) Print(task, books, language, file != tasks.front());
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "coach-lesson-transcript: %s\n", error.what());
    return 1;
  }
  return 0;
}
