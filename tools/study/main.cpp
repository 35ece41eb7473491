// coach-study: the paper's experiments on simulated scenes, one command each.
#include <CLI/CLI.hpp>
#include <iostream>

#include "tools/study/experiments.h"
#include "tools/study/study.h"

namespace {

int Run(int argc, char** argv) {
  CLI::App app(
      "Runs an experiment on simulated scenes. Results are kept in OUT and not computed again; the same command "
      "with another --shard on another machine does another part, --merge makes the report.");
  std::string name, out, shard;
  int units = 10;
  bool merge = false;
  coach::StudyRun run;
  coach::ExperimentOptions options;
  options.tasks = "deploy/tasks";
  app.add_option("STUDY", name, "fig4, start, table1, guidance or ablation")->required();
  app.add_option("--out", out, "folder of the results; default: study-STUDY");
  app.add_option("-n,--seeds,--scenes,--lessons", units, "how many")->check(CLI::Range(1, 9999))->capture_default_str();
  app.add_option("--shard", shard, "i/n: only the i-th of n parts; no report");
  app.add_option("--jobs", run.jobs, "units at a time")->check(CLI::Range(1, 64))->capture_default_str();
  app.add_option("--seconds", options.seconds, "length of a scene, 0: the experiment's own")
      ->check(CLI::Range(0.0, 600.0));
  app.add_option("--fps", options.fps, "Hz, of lessons")->check(CLI::Range(1.0, 60.0))->capture_default_str();
  app.add_option("--tasks", options.tasks, "folder of task files")->capture_default_str();
  app.add_flag("--merge", merge, "only the report, of the results that are there");
  app.add_flag("--keep-scenes", options.keep_scenes, "in OUT/scenes; a scene that is there is not made again");
  CLI11_PARSE(app, argc, argv);
  const coach::Experiment& experiment = coach::FindExperiment(name);
  run.folder = out.empty() ? "study-" + name : out;
  if (!shard.empty()) run.shard = coach::ParseShard(shard);
  options.tracker = std::filesystem::canonical("/proc/self/exe").parent_path() / "coach-track-sequence";
  options.scratch = run.folder / "scenes";
  const auto names = experiment.Units(units);
  int failed = 0;
  if (!merge) {
    const auto unit = [&](const std::string& unit_name) {
      const auto at = std::find(names.begin(), names.end(), unit_name);
      return experiment.Run(static_cast<int>(at - names.begin()) + 1, options);
    };
    failed = coach::RunUnits(run, names, unit, std::cerr);
  }
  if (shard.empty()) {
    std::vector<std::string> missing;
    const auto results = coach::ReadUnits(run.folder, names, &missing);
    std::cout << experiment.Report(results, run.folder);
    if (!missing.empty()) std::cerr << missing.size() << " of " << names.size() << " units are missing\n";
    failed += static_cast<int>(missing.size());
  }
  return failed == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << "coach-study: " << e.what() << "\n";
    return 1;
  }
}
