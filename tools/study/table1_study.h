// The paper's Table I on simulated lessons.
#pragma once

#include "tools/study/experiments.h"

namespace coach {

/// A unit is one lesson, tracked in both modes: which connections were noticed, and when. Tasks (rectangles and square)
/// and children's styles take turns.
class Table1Study : public Experiment {
 public:
  std::string name() const override { return "table1"; }
  std::string Run(int number, const ExperimentOptions& options) const override;
  std::string Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const override;
};

}  // namespace coach
