// Experiments on simulated scenes: the paper's Fig. 4, starting from nothing, Table I, what guidance
// brings, and what each cure of the tracker brings.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace coach {

struct ExperimentOptions {
  std::filesystem::path tasks;    ///< folder of the shipped tasks
  std::filesystem::path tracker;  ///< coach-track-sequence
  std::filesystem::path scratch;  ///< scenes are made here and removed
  double fps = 15;                ///< Hz, of lessons
  double seconds = 0;             ///< s, of a scene; 0: the experiment's own length
  bool keep_scenes = false;
};

/// One kind of experiment: names of its units, a unit's result as JSON text, the report of many.
class Experiment {
 public:
  virtual ~Experiment() = default;
  /// Names carry all that a unit needs: fig4-seed003.
  virtual std::vector<std::string> Units(int n) const;
  virtual std::string name() const = 0;
  /// @throws std::runtime_error if the tracker fails.
  virtual std::string Run(int number, const ExperimentOptions& options) const = 0;
  /// Writes tables (Markdown, csv) and pictures into `folder`. @returns the Markdown.
  virtual std::string Report(const std::vector<std::string>& results, const std::filesystem::path& folder) const = 0;
};

/// fig4, start, table1, guidance or ablation. @throws std::invalid_argument for another name.
const Experiment& FindExperiment(const std::string& name);

}  // namespace coach
