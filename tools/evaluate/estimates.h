// What a tracker wrote: poses, states, events, timings (docs/formats.md, "Results").
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/evaluate/scene_truth.h"

namespace coach {

/// One row of the states file.
struct StateRow {
  std::string status;
  Matrix6 covariance = Matrix6::Zero();  ///< camera frame, m and rad
};

struct EventRow {
  double time = 0;  ///< s, when it happened
  std::string connection, kind;
  double decided = 0;  ///< s, when it was announced; `time` if the file does not say
};

struct Estimates {
  std::string name;
  /// [frame of the truth][slot]: the n-th row of an object id belongs to the n-th part with that id.
  std::vector<std::vector<std::optional<Pose>>> X_CP;
  std::vector<std::vector<std::optional<StateRow>>> states;  ///< the same; empty without a states file
  std::vector<EventRow> events;
  bool has_events = false;
  std::map<std::string, std::vector<double>> stage_ms;  ///< by stage, one value a frame
};

struct ResultFiles {
  std::filesystem::path poses;
  std::filesystem::path events, states, timings;  ///< may be empty
};

/// The files that belong to POSES.csv by name: in its folder events.csv, states.csv and timings.csv, or with the
/// same prefix (run_poses.csv, run_events.csv).
ResultFiles Companions(const std::filesystem::path& poses);

/// @throws std::runtime_error naming the file and line.
Estimates ReadEstimates(const ResultFiles& files, const SceneTruth& truth);

}  // namespace coach
