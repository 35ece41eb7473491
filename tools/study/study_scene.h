// Simulated scenes on disk, and what a tracker makes of them.
#pragma once

#include "tools/evaluate/evaluation.h"
#include "tools/simulator/scenario.h"
#include "tools/study/experiments.h"

namespace coach {

/// Renders a scenario into a folder unless that is there already. Until it is whole it has a name of its own, so that
/// several processes can want the same one.
void RenderOnce(const Scenario& scenario, const std::filesystem::path& folder);

/// A scene of one unit: removed when this is destroyed, unless the options keep scenes, which are then used again.
class StudyScene {
 public:
  StudyScene(const std::string& name, const Task& task, const ScenarioOptions& scenario,
             const ExperimentOptions& options);
  ~StudyScene();
  StudyScene(const StudyScene&) = delete;
  StudyScene& operator=(const StudyScene&) = delete;

  const SceneTruth& truth() const { return truth_; }

  /// Tracks the scene in another process and scores the result. @param mode full or paper
  /// @throws std::runtime_error with the tracker's last words if it fails.
  Evaluation Track(const std::string& mode) const;

 private:
  std::filesystem::path folder_;
  std::filesystem::path tracker_;
  bool keep_;
  SceneTruth truth_;
};

}  // namespace coach
