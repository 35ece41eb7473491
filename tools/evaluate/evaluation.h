// Results of trackers on one scene, side by side: tables, the targets, plots.
#pragma once

#include <string>
#include <vector>

#include "tools/evaluate/event_scores.h"
#include "tools/evaluate/pose_scores.h"
#include "tools/evaluate/svg_plot.h"

namespace coach {

struct Evaluation {
  std::string name;
  Estimates estimates;
  PoseErrors errors;
  PoseScores poses;
  EventScores events;
};
Evaluation Evaluate(const SceneTruth& truth, Estimates estimates);

/// One column a result.
std::string ScoreTable(const SceneTruth& truth, const std::vector<Evaluation>& results);

/// One of the project's targets, on one result.
struct Target {
  std::string what, bound;
  std::string measured;  ///< "-" if the result does not say
  enum class Verdict { kMet, kNotMet, kUnknown } verdict = Verdict::kUnknown;
};
std::vector<Target> CheckTargets(const SceneTruth& truth, const Evaluation& result);
std::string TargetTable(const SceneTruth& truth, const std::vector<Evaluation>& results);

/// Position error of the worst part that is at least 0.1 visible, over time; bands: a part is hidden.
Plot ErrorPlot(const SceneTruth& truth, const std::vector<Evaluation>& results);
/// The paper's Fig. 4: error of the distance between the first two parts; bands: one is hidden, jolts.
Plot DistancePlot(const SceneTruth& truth, const std::vector<Evaluation>& results);

}  // namespace coach
