// coach-lesson-transcript: a simulated lesson as a teacher would read it, in every language, as Markdown.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "common/assembly/task_file.h"
#include "services/assembly_reasoner/lesson_configuration.h"
#include "tools/evaluate_reasoner/pose_script.h"
#include "tools/evaluate_reasoner/recorded_poses.h"

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

/// One lesson, printed as it goes: a row for what happens and for what the robot says.
class Transcript {
 public:
  Transcript(const std::vector<Task>& tasks, const std::map<std::string, PhraseBook>& books,
             const LessonOptions& options)
      : tasks_(tasks), lesson_(tasks, books, options, "CLASS") {}

  /// The child builds one task after the other, and waits for the next one to be introduced.
  void Print() {
    for (size_t i = 0; i < tasks_.size(); ++i) {
      task_ = &tasks_[i];
      const ScriptedLesson script = PlayScript(*task_, HesitantChild(*task_), {}, kRate, 3);
      if (start_ == 0) start_ = now_ = script.frames.front().utime;
      for (const PartPoses& poses : script.frames) StepNext(poses);
      for (int k = 0; i + 1 < tasks_.size() && lesson_.task().name == task_->name && k < kMostRest * kRate; ++k)
        StepNext(script.frames.back());
    }
  }
  /// What the tracker said of a recorded session of the first task.
  void Print(const std::vector<PartPoses>& recording) {
    start_ = recording.front().utime;
    for (const PartPoses& poses : recording) Step(poses);
  }

 private:
  static constexpr int kRate = 15;       // Hz
  static constexpr int kMostRest = 120;  // s

  void StepNext(PartPoses poses) {
    poses.utime = now_ + 1000000 / kRate;
    Step(poses);
  }
  void Step(const PartPoses& poses) {
    now_ = poses.utime;
    if (robot_id_ != 0 && now_ >= robot_until_) {
      RobotStatus status;
      status.session = lesson_.session();
      status.command_id = robot_id_;
      status.state = ActState::kDone;
      lesson_.Handle(status);
      robot_id_ = 0;
    }
    const LessonOutput out = lesson_.Step(poses);
    for (const GuidanceEvent& e : out.events) Show(e);
    for (const RobotCommand& c : out.commands) {
      if (c.kind == ActKind::kAct) Show(c);
    }
  }
  void Show(const GuidanceEvent& e) const {
    const bool joint = e.kind == "connect" || e.kind == "wrong" || e.kind == "disconnect" || e.kind == "repair";
    if (joint)
      std::printf("| %s | *%s %s* (%s and %s) | | |\n", Clock(e.since - start_).c_str(), e.kind.c_str(),
                  e.subject.c_str(), task_->parts[e.part_a].name.c_str(), task_->parts[e.part_b].name.c_str());
    if (e.kind == "session")
      std::printf("| %s | *%s: %s* | | |\n", Clock(now_ - start_).c_str(), e.subject.c_str(), e.reason.c_str());
  }
  void Show(const RobotCommand& c) {
    std::string does;
    const auto add = [&](const std::string& what) { does += (does.empty() ? "" : ", ") + what; };
    if (c.point_target) add("points");
    if (c.look_target) add("looks");
    if (!c.eye_colour.empty()) add(c.eye_colour + " eyes");
    std::printf("| %s | %s | %s | %s |\n", Clock(now_ - start_).c_str(), c.phrase_key.c_str(), c.text.c_str(),
                does.c_str());
    robot_id_ = c.id;
    robot_until_ = now_ + static_cast<int64_t>((0.5 + CountCharacters(c.text) / 14.0) * 1e6);
  }

  const std::vector<Task>& tasks_;
  const Task* task_ = tasks_.data();
  Lesson lesson_;
  int64_t start_ = 0, now_ = 0, robot_until_ = 0, robot_id_ = 0;  // us
};

void Print(const std::vector<Task>& tasks, const std::map<std::string, PhraseBook>& books, const std::string& language,
           bool group, const std::vector<PartPoses>& recording = {}) {
  LessonOptions options;
  options.language = language;
  options.group = group;
  options.start_by_itself = true;
  options.in_a_row = static_cast<int>(tasks.size());
  std::string names;
  for (const Task& task : tasks) names += (names.empty() ? "" : ", then ") + task.name;
  std::printf("\n## %s, %s, %s\n\n| time | what happens | the robot says | and does |\n|---|---|---|---|\n",
              names.c_str(), language.c_str(), group ? "a group" : "one child");
  Transcript transcript(tasks, books, options);
  recording.empty() ? transcript.Print() : transcript.Print(recording);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Prints simulated lessons in every language");
  std::vector<std::string> tasks;
  std::string phrases, recording;
  bool in_a_row = false;
  app.add_option("tasks", tasks, "task files")->required()->check(CLI::ExistingFile);
  app.add_option("--phrases", phrases, "folder of phrase files instead of the shipped ones");
  app.add_option("--recording", recording, "recorded PART_POSES of the first task instead of a simulated child")
      ->check(CLI::ExistingFile);
  app.add_flag("--in-a-row", in_a_row, "one lesson of all the tasks, after the lessons of one each");
  CLI11_PARSE(app, argc, argv);
  try {
    const auto books = LoadPhraseBooks(phrases.empty() ? ShippedPhrases() : std::filesystem::path(phrases));
    if (!recording.empty()) {
      const std::vector<PartPoses> poses = ReadPartPoses(recording);
      for (const auto& [language, book] : books) Print({LoadTask(tasks.front())}, books, language, false, poses);
      return 0;
    }
    std::printf(
        "# Simulated lessons\n\nMade by `coach-lesson-transcript`. The child thinks for long, joins two pieces "
        "that do not belong together, misses narrowly, and ends well.\n");
    std::vector<Task> all;
    for (const std::string& file : tasks) {
      all.push_back(LoadTask(file));
      for (const auto& [language, book] : books) Print({all.back()}, books, language, all.size() > 1);
    }
    for (const auto& [language, book] : books) {
      if (in_a_row) Print(all, books, language, true);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "coach-lesson-transcript: %s\n", error.what());
    return 1;
  }
  return 0;
}
