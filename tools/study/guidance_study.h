// What guidance brings: simulated children of three tempers build with and without the robot's words.
#pragma once

#include "tools/study/experiments.h"

namespace coach {

/// A unit is one room and task, in which a child of each temper builds twice: the robot speaks, or is silent. The loop
/// is closed in one process: the true poses with a tracker's noise go to the lesson that the reasoner runs, its words
/// to the child once they are said. Without pictures: the tracker has studies of its own.
class GuidanceStudy : public Experiment {
 public:
  std::string name() const override { return "guidance"; }
  std::string Run(int number, const ExperimentOptions& options) const override;
  std::string Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const override;
};

}  // namespace coach
