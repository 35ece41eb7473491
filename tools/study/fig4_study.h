// The paper's Fig. 4 on simulated scenes.
#pragma once

#include "tools/study/experiments.h"

namespace coach {

/// A unit is one scene of two bricks before a moving camera, tracked in both modes: the error of the bricks' distance
/// over time, with the times of occlusions and jolts.
class Fig4Study : public Experiment {
 public:
  std::string name() const override { return "fig4"; }
  std::string Run(int number, const ExperimentOptions& options) const override;
  std::string Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const override;
};

}  // namespace coach
