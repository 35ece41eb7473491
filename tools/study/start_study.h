// Whether all parts are found from nothing.
#pragma once

#include "tools/study/experiments.h"

namespace coach {

/// A unit is one scene of a second with all parts of a task apart on the table, resting on any face; the tasks take
/// turns.
class StartStudy : public Experiment {
 public:
  std::string name() const override { return "start"; }
  std::string Run(int number, const ExperimentOptions& options) const override;
  std::string Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const override;
};

}  // namespace coach
