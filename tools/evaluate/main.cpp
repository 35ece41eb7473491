// coach-evaluate: how good trackers' results on a scene are, side by side and against the targets.
#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "tools/evaluate/difficulty.h"
#include "tools/evaluate/evaluation.h"

namespace {

int Run(int argc, char** argv) {
  CLI::App app(
      "Scores results on a scene with ground truth: accuracy, losses, identity, connections, targets.\n"
      "RESULTS is a poses csv; events, states and timings are found beside it by name (poses.csv: events.csv).");
  std::vector<std::string> inputs, names;
  std::string plots;
  bool difficulty = false;
  app.add_option("SCENE RESULTS...", inputs, "scene folder, then poses csv files; with --difficulty: scene folders")
      ->required();
  app.add_option("--names", names, "of the results, in their order")->delimiter(',');
  app.add_option("--plots", plots, "folder for error.svg (and distance.svg)");
  app.add_flag("--difficulty", difficulty, "prints how hard scenes are: visible fraction, speed, noise");
  CLI11_PARSE(app, argc, argv);
  if (difficulty) {
    std::vector<coach::Difficulty> scenes;
    for (const std::string& scene : inputs) scenes.push_back(coach::MeasureDifficulty(coach::ReadSceneTruth(scene)));
    std::cout << coach::DifficultyTable(scenes);
    return 0;
  }
  if (inputs.size() < 2) throw std::invalid_argument("a scene and at least one poses csv are needed (--help)");
  const coach::SceneTruth truth = coach::ReadSceneTruth(inputs[0]);
  std::vector<coach::Evaluation> results;
  for (size_t i = 1; i < inputs.size(); ++i) {
    coach::Estimates estimates = coach::ReadEstimates(coach::Companions(inputs[i]), truth);
    if (i <= names.size()) estimates.name = names[i - 1];
    results.push_back(coach::Evaluate(truth, std::move(estimates)));
  }
  std::cout << coach::ScoreTable(truth, results) << "\n" << coach::TargetTable(truth, results);
  if (plots.empty()) return 0;
  std::filesystem::create_directories(plots);
  coach::WriteSvg(std::filesystem::path(plots) / "error.svg", coach::ErrorPlot(truth, results));
  if (truth.scenario == "fig4")
    coach::WriteSvg(std::filesystem::path(plots) / "distance.svg", coach::DistancePlot(truth, results));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << "coach-evaluate: " << e.what() << "\n";
    return 1;
  }
}
