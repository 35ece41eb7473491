#include "tools/study/table1_study.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/assembly/task_file.h"
#include "tools/study/report_text.h"
#include "tools/study/study_scene.h"

namespace coach {
namespace {

using Json = nlohmann::json;

struct Tally {
  std::vector<double> errors;
  int all = 0, correct = 0, five = 0, twenty = 0, correct_five = 0, correct_twenty = 0, prompt = 0, false_alarms = 0,
      right_end = 0;
};

Tally Count(const std::vector<Json>& units, const std::string& mode) {
  Tally t;
  for (const Json& u : units) {
    const Json& m = u["modes"][mode];
    t.false_alarms += m["false_alarms"].get<int>();
    t.right_end += m["final_state_right"].get<bool>();
    for (const Json& c : m["connections"]) {
      const bool correct = c["correct"].get<bool>();
      ++t.all, t.correct += correct;
      if (c["error"].is_null()) continue;
      const double error = std::abs(c["error"].get<double>());
      t.errors.push_back(error);
      t.five += error <= 5, t.twenty += error <= 20;
      t.correct_five += correct && error <= 5, t.correct_twenty += correct && error <= 20;
      t.prompt += c["delay"].get<double>() <= 1;
    }
  }
  return t;
}

std::string Rows(const std::vector<Json>& units, const std::array<const char*, 7>& paper) {
  const Tally f = Count(units, "full"), p = Count(units, "paper");
  const int n = static_cast<int>(units.size());
  std::vector<double> completion;
  double mistakes = 0;
  for (const Json& u : units) completion.push_back(u["completion"]), mistakes += u["mistakes"].get<int>();
  std::ostringstream md;
  const auto row = [&](const std::string& what, const std::string& full, const std::string& own_paper,
                       const std::string& children) {
    md << "| " << what << " | " << full << " | " << own_paper << " | " << children << " |\n";
  };
  row("median time error (s)", Median(f.errors), Median(p.errors), paper[0]);
  row("all connections within 5 s", Share(f.five, f.all), Share(p.five, p.all), paper[1]);
  row("all connections within 20 s", Share(f.twenty, f.all), Share(p.twenty, p.all), paper[2]);
  row("correct ones within 5 s", Share(f.correct_five, f.correct), Share(p.correct_five, p.correct), paper[3]);
  row("correct ones within 20 s", Share(f.correct_twenty, f.correct), Share(p.correct_twenty, p.correct), paper[4]);
  row("announced within 1 s of being visible", Share(f.prompt, f.all), Share(p.prompt, p.all), "-");
  row("false alarms a lesson", n ? Number(1.0 * f.false_alarms / n) : "-", n ? Number(1.0 * p.false_alarms / n) : "-",
      "-");
  row("final state right", Share(f.right_end, n), Share(p.right_end, n), "-");
  const std::string made = n ? Number(mistakes / n) : "-";
  row("mistakes a lesson", made, made, paper[5]);
  row("completion (s)", Median(completion, 1), Median(completion, 1), paper[6]);
  return md.str();
}

}  // namespace

std::string Table1Study::Run(int number, const ExperimentOptions& options) const {
  static constexpr const char* kTasks[] = {"rectangle_long_medium", "rectangle_long_short", "square"};
  static constexpr const char* kStyles[] = {"normal", "slow", "hasty", "hesitant"};
  const std::string task = kTasks[number % 3], style = kStyles[number % 4];
  ScenarioOptions scenario;
  scenario.seed = static_cast<uint64_t>(2000 + number);
  scenario.fps = options.fps;
  scenario.seconds = options.seconds;
  scenario.style = style;
  scenario.mistakes = 0.8;
  const StudyScene scene(Units(number).back(), LoadTask(options.tasks / (task + ".yaml")), scenario, options);
  Json unit{{"number", number}, {"task", task}, {"style", style}};
  double completion = 0;
  int mistakes = 0;
  std::map<std::string, bool> correct;
  for (const TruthEvent& e : scene.truth().events) {
    if (e.kind == "connect") completion = std::max(completion, e.time), correct[e.connection] = true;
    mistakes += e.kind == "wrong_connect";
  }
  unit["completion"] = completion;
  unit["mistakes"] = mistakes;
  for (const char* mode : {"full", "paper"}) {
    const Evaluation r = scene.Track(mode);
    Json m{{"false_alarms", r.events.false_alarms},
           {"final_state_right", r.events.final_state_right},
           {"success", r.poses.success_30},
           {"connections", Json::array()}};
    for (const Announcement& a : r.events.connections) {
      m["connections"].push_back({{"correct", correct.count(a.connection) > 0},
                                  {"error", a.error ? Json(*a.error) : Json()},
                                  {"delay", a.delay ? Json(*a.delay) : Json()}});
    }
    unit["modes"][mode] = m;
  }
  return unit.dump();
}

std::string Table1Study::Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const {
  std::vector<Json> units;
  for (const std::string& text : results) units.push_back(Json::parse(text));
  std::ostringstream md, csv;
  csv << "number,task,style,mode,correct,error_s,delay_s\n";
  for (const Json& u : units) {
    for (const auto& [mode, m] : u["modes"].items()) {
      for (const Json& c : m["connections"]) {
        csv << u["number"] << "," << u["task"].get<std::string>() << "," << u["style"].get<std::string>() << "," << mode
            << "," << c["correct"] << "," << c["error"] << "," << c["delay"] << "\n";
      }
    }
  }
  md << "# Connections noticed (the paper's Table I), " << units.size()
     << " simulated lessons\n\nShares with counts and 95 % Wilson intervals; medians with bootstrap intervals. "
        "Simulated lessons and the paper's children are not the same trials.\n";
  struct Group {
    const char* title;
    bool square;
    std::array<const char*, 7> paper;
  };
  for (const Group& g : {Group{"Rectangles", false, {"3.42", "50.0 %", "56.3 %", "70.0 %", "80.0 %", "0.86", "48.49"}},
                         Group{"Square", true, {"7.02", "43.2 %", "59.5 %", "39.4 %", "57.6 %", "0.67", "110.09"}}}) {
    std::vector<Json> of_group;
    for (const Json& u : units) {
      if ((u["task"] == "square") == g.square) of_group.push_back(u);
    }
    md << "\n## " << g.title << " (" << of_group.size()
       << " lessons)\n\n| | full mode | paper mode | the paper's children |\n|---|---|---|---|\n"
       << Rows(of_group, g.paper);
  }
  WriteText(folder / "table1.csv", csv.str());
  WriteText(folder / "table1.md", md.str());
  return md.str();
}

}  // namespace coach
