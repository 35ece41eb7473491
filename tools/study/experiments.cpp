#include "tools/study/experiments.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "common/assembly/task_file.h"
#include "tools/evaluate/evaluation.h"
#include "tools/simulator/scene_recorder.h"
#include "tools/study/ablation.h"
#include "tools/study/guidance_study.h"
#include "tools/study/report_text.h"
#include "tools/study/study.h"

namespace coach {
namespace {

using Json = nlohmann::json;

/// A scene that is there as long as this lives.
class TemporaryScene {
 public:
  TemporaryScene(const std::string& name, const Task& task, const ScenarioOptions& scenario,
                 const ExperimentOptions& options)
      : folder_(options.scratch / name), keep_(options.keep_scenes) {
    std::filesystem::remove_all(folder_);
    const Scenario made = MakeScenario(task, scenario);
    RecordScene(made, folder_ / "scene", {}, {});
    rate_ = made.id_rate;
  }
  ~TemporaryScene() {
    std::error_code ignored;
    if (!keep_) std::filesystem::remove_all(folder_, ignored);
  }
  TemporaryScene(const TemporaryScene&) = delete;
  TemporaryScene& operator=(const TemporaryScene&) = delete;

  std::filesystem::path scene() const { return folder_ / "scene"; }

  /// Tracks the scene in another process and scores the result.
  Evaluation Track(const std::string& mode, const ExperimentOptions& options) const {
    const auto file = [&](const std::string& kind) { return (folder_ / (mode + "_" + kind)).string(); };
    std::ostringstream command;
    command << "'" << options.tracker.string() << "' '" << scene().string() << "' --task '"
            << (scene() / "task.yaml").string() << "' --fps " << rate_ << " --poses '" << file("poses.csv")
            << "' --states '" << file("states.csv") << "' --events '" << file("events.csv") << "' --timings '"
            << file("timings.csv") << "'" << (mode == "paper" ? " --paper" : "") << " > '" << file("log") << "' 2>&1";
    if (std::system(command.str().c_str()) != 0) {
      std::ifstream log(file("log"));
      std::string text{std::istreambuf_iterator<char>(log), std::istreambuf_iterator<char>()};
      throw std::runtime_error("the tracker failed: " + text.substr(text.size() > 200 ? text.size() - 200 : 0));
    }
    const SceneTruth truth = ReadSceneTruth(scene());
    Estimates estimates = ReadEstimates(Companions(file("poses.csv")), truth);
    estimates.name = mode;
    return Evaluate(truth, std::move(estimates));
  }

 private:
  std::filesystem::path folder_;
  bool keep_;
  double rate_ = 30;
};

Json Finite(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double x : values) list.push_back(std::isfinite(x) ? Json(std::round(1e4 * x) / 1e4) : Json());
  return list;
}

std::vector<double> Doubles(const Json& list) {
  std::vector<double> values;
  for (const Json& x : list) values.push_back(x.is_null() ? std::numeric_limits<double>::infinity() : x.get<double>());
  return values;
}

int Recovered(const PoseScores& s) {
  return static_cast<int>(std::count_if(s.recoveries.begin(), s.recoveries.end(),
                                        [](const Recovery& r) { return r.after && *r.after <= 0.2 + 1e-9; }));
}

/// Two bricks, one long and one medium, and nothing to build.
Task TwoBricks(const ExperimentOptions& options) { return LoadTask(options.tasks / "two_bricks.yaml"); }

// ---------------------------------------------------------------- Fig. 4

class Fig4Study : public Experiment {
 public:
  std::string name() const override { return "fig4"; }

  std::string Run(int number, const ExperimentOptions& options) const override {
    ScenarioOptions scenario;
    scenario.name = "fig4";
    scenario.seed = static_cast<uint64_t>(number);
    scenario.fps = 30;
    scenario.seconds = options.seconds > 0 ? options.seconds : 24;
    const TemporaryScene scene(Units(number).back(), TwoBricks(options), scenario, options);
    const SceneTruth truth = ReadSceneTruth(scene.scene());
    Json unit{{"seed", number}};
    for (const char* mode : {"full", "paper"}) {
      const Evaluation r = scene.Track(mode, options);
      const Plot plot = DistancePlot(truth, {r});
      if (!unit.contains("time")) {
        unit["time"] = Finite(plot.series[0].x);
        for (const PlotBand& band : plot.bands) unit["bands"].push_back({band.from, band.to, band.colour});
      }
      unit["modes"][mode] = {{"distance_mm", Finite(plot.series[0].y)},
                             {"both_visible_median", r.poses.distance_mm.median},
                             {"both_visible_p95", r.poses.distance_mm.p95},
                             {"success", r.poses.success_30},
                             {"lost_seconds", r.poses.lost_seconds},
                             {"reappearances", r.poses.recoveries.size()},
                             {"recovered", Recovered(r.poses)}};
    }
    return unit.dump();
  }

  std::string Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const override {
    std::ostringstream md, csv;
    csv << "seed,mode,time,distance_error_mm\n";
    std::map<std::string, std::vector<double>> median, p95, success, lost;
    std::map<std::string, int> back, gone;
    for (const std::string& text : results) {
      const Json unit = Json::parse(text);
      Plot plot{.title = "Error of the distance between two bricks, seed " + unit["seed"].dump(),
                .x_label = "time (s)",
                .y_label = "mm",
                .y_low = 0.01,
                .y_high = 1000};
      plot.bands_legend = "red: a brick is hidden, blue: jolt";
      for (const Json& b : unit.value("bands", Json::array()))
        plot.bands.push_back({b[0], b[1], b[2].get<std::string>()});
      const auto time = Doubles(unit["time"]);
      for (const auto& [mode, m] : unit["modes"].items()) {
        plot.series.push_back({mode, time, Doubles(m["distance_mm"])});
        for (size_t i = 0; i < time.size(); ++i)
          csv << unit["seed"] << "," << mode << "," << time[i] << "," << m["distance_mm"][i] << "\n";
        median[mode].push_back(m["both_visible_median"]), p95[mode].push_back(m["both_visible_p95"]);
        success[mode].push_back(m["success"]), lost[mode].push_back(m["lost_seconds"]);
        back[mode] += m["recovered"].get<int>(), gone[mode] += m["reappearances"].get<int>();
      }
      WriteSvg(folder / ("fig4_seed" + unit["seed"].dump() + ".svg"), plot);
    }
    md << "# Two bricks before a moving camera (the paper's Fig. 4), " << results.size() << " scenes\n\n"
       << "Median over the scenes with its 95 % bootstrap interval; the curves are in fig4.csv and fig4_seed*.svg.\n\n"
       << "| | full | paper |\n|---|---|---|\n";
    const auto row = [&](const std::string& what, auto& values) {
      md << "| " << what << " | " << Median(values["full"]) << " | " << Median(values["paper"]) << " |\n";
    };
    row("distance error, both visible, median (mm)", median);
    row("distance error, both visible, p95 (mm)", p95);
    row("part-frames within 20 mm and 10 deg (%)", success);
    row("seconds lost", lost);
    md << "| back within 0.2 s of reappearing | " << Share(back["full"], gone["full"]) << " | "
       << Share(back["paper"], gone["paper"]) << " |\n";
    WriteText(folder / "fig4.csv", csv.str());
    WriteText(folder / "fig4.md", md.str());
    return md.str();
  }
};

// ---------------------------------------------------------------- starting from nothing

class StartStudy : public Experiment {
 public:
  std::string name() const override { return "start"; }

  std::string Run(int number, const ExperimentOptions& options) const override {
    static constexpr const char* kTasks[] = {"rectangle_long_medium", "rectangle_long_short", "square", "car"};
    const std::string task = kTasks[number % 4];
    ScenarioOptions scenario;
    scenario.name = "start";
    scenario.seed = static_cast<uint64_t>(1000 + number);
    scenario.fps = 10;
    scenario.seconds = 1.1;
    const TemporaryScene scene(Units(number).back(), LoadTask(options.tasks / (task + ".yaml")), scenario, options);
    const Evaluation r = scene.Track("full", options);
    const bool found = r.poses.start_seconds && *r.poses.start_seconds <= 1.0 + 1e-9;
    int wrong = 0;
    for (size_t k = 0; k < r.errors.position_mm.size(); ++k) {
      wrong += !(r.errors.position_mm[k].back() < 20 && r.errors.rotation_deg[k].back() < 10);
    }
    return Json{{"number", number},
                {"task", task},
                {"found", found},
                {"after", found ? Json(*r.poses.start_seconds) : Json()},
                {"parts", r.errors.position_mm.size()},
                {"wrong_parts", wrong}}
        .dump();
  }

  std::string Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const override {
    std::map<std::string, std::array<int, 2>> by_task;  // failures, scenes
    std::ostringstream md, csv, failures;
    csv << "number,task,found,after,parts,wrong_parts\n";
    int failed = 0, wrong = 0, parts = 0;
    for (const std::string& text : results) {
      const Json u = Json::parse(text);
      csv << u["number"] << "," << u["task"].get<std::string>() << "," << u["found"] << "," << u["after"] << ","
          << u["parts"] << "," << u["wrong_parts"] << "\n";
      auto& entry = by_task[u["task"]];
      ++entry[1];
      wrong += u["wrong_parts"].get<int>(), parts += u["parts"].get<int>();
      if (u["found"].get<bool>()) continue;
      ++failed, ++entry[0];
      failures << " " << u["number"];
    }
    md << "# Starting from nothing, " << results.size()
       << " scenes\n\nA start fails if not all parts are within 20 mm and 10 degrees (modulo symmetry) within 1 s.\n\n"
       << "| task | failures (95 % interval) |\n|---|---|\n";
    for (const auto& [task, entry] : by_task) md << "| " << task << " | " << Share(entry[0], entry[1]) << " |\n";
    md << "| all | " << Share(failed, static_cast<int>(results.size())) << " |\n| parts wrong at the end | "
       << Share(wrong, parts) << " |\n\nFailed:" << failures.str() << "\n";
    WriteText(folder / "start.csv", csv.str());
    WriteText(folder / "start.md", md.str());
    return md.str();
  }
};

// ---------------------------------------------------------------- Table I

class Table1Study : public Experiment {
 public:
  std::string name() const override { return "table1"; }

  std::string Run(int number, const ExperimentOptions& options) const override {
    static constexpr const char* kTasks[] = {"rectangle_long_medium", "rectangle_long_short", "square"};
    static constexpr const char* kStyles[] = {"normal", "slow", "hasty", "hesitant"};
    const std::string task = kTasks[number % 3], style = kStyles[number % 4];
    ScenarioOptions scenario;
    scenario.seed = static_cast<uint64_t>(2000 + number);
    scenario.fps = options.fps;
    scenario.seconds = options.seconds;
    scenario.style = style;
    scenario.mistakes = 0.8;
    const TemporaryScene scene(Units(number).back(), LoadTask(options.tasks / (task + ".yaml")), scenario, options);
    const SceneTruth truth = ReadSceneTruth(scene.scene());
    Json unit{{"number", number}, {"task", task}, {"style", style}};
    double completion = 0;
    int mistakes = 0;
    std::map<std::string, bool> correct;
    for (const TruthEvent& e : truth.events) {
      if (e.kind == "connect") completion = std::max(completion, e.time), correct[e.connection] = true;
      mistakes += e.kind == "wrong_connect";
    }
    unit["completion"] = completion;
    unit["mistakes"] = mistakes;
    for (const char* mode : {"full", "paper"}) {
      const Evaluation r = scene.Track(mode, options);
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

  std::string Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const override {
    std::vector<Json> units;
    for (const std::string& text : results) units.push_back(Json::parse(text));
    std::ostringstream md, csv;
    csv << "number,task,style,mode,correct,error_s,delay_s\n";
    for (const Json& u : units) {
      for (const auto& [mode, m] : u["modes"].items()) {
        for (const Json& c : m["connections"]) {
          csv << u["number"] << "," << u["task"].get<std::string>() << "," << u["style"].get<std::string>() << ","
              << mode << "," << c["correct"] << "," << c["error"] << "," << c["delay"] << "\n";
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
    for (const Group& g :
         {Group{"Rectangles", false, {"3.42", "50.0 %", "56.3 %", "70.0 %", "80.0 %", "0.86", "48.49"}},
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

 private:
  struct Tally {
    std::vector<double> errors;
    int all = 0, correct = 0, five = 0, twenty = 0, correct_five = 0, correct_twenty = 0, prompt = 0, false_alarms = 0,
        right_end = 0;
  };

  static Tally Count(const std::vector<Json>& units, const std::string& mode) {
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

  static std::string Rows(const std::vector<Json>& units, const std::array<const char*, 7>& paper) {
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
};

}  // namespace

std::vector<std::string> Experiment::Units(int n) const {
  std::vector<std::string> units;
  for (int i = 1; i <= n; ++i) {
    std::ostringstream unit;
    unit << name() << "-" << std::setw(4) << std::setfill('0') << i;
    units.push_back(unit.str());
  }
  return units;
}

const Experiment& FindExperiment(const std::string& name) {
  static const Fig4Study fig4;
  static const StartStudy start;
  static const Table1Study table1;
  static const GuidanceStudy guidance;
  static const AblationStudy ablation;
  for (const Experiment* e : std::initializer_list<const Experiment*>{&fig4, &start, &table1, &guidance, &ablation}) {
    if (e->name() == name) return *e;
  }
  throw std::invalid_argument("study: found " + name + ", expected fig4, start, table1, guidance or ablation");
}

}  // namespace coach
