// What each cure of the full mode brings, over hard scenes of our own: the paper's mode, the full mode, the full mode
// without one cure at a time, and the paper's mode with the other two uses of colour of its section IV-C.
#pragma once

#include "tools/study/experiments.h"

namespace coach {

/// One scene of the ablation, made by the simulator; fixed, so that results of different days compare.
struct AblationScene {
  const char* name;  ///< of the simulator's scenario too
  const char* task;
  const char* style;  ///< of the child
  uint64_t seed;
  double seconds;  ///< s at most: longer lessons are cut
  bool held_back;  ///< looked at only when all options are fixed; reported apart
};
const std::vector<AblationScene>& AblationScenes();

/// A unit is one scene with one seed of the tracker, tracked by every variant together (coach-track-sequence
/// --variants). Scenes are rendered once and
/// kept in the study's folder.
class AblationStudy : public Experiment {
 public:
  std::string name() const override { return "ablation"; }
  /// All scenes with seed 1, then all with seed 2, up to n.
  std::vector<std::string> Units(int n) const override;
  std::string Run(int number, const ExperimentOptions& options) const override;
  std::string Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const override;
};

}  // namespace coach
