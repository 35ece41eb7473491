// Runs detector, filter and reasoner over a recorded scene, lockstep, through the libraries that the services run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"

namespace coach {

struct SequenceOptions {
  std::filesystem::path scene;  ///< scene folder
  std::filesystem::path task;   ///< task file
  std::filesystem::path poses;  ///< results to write; empty: not written; so are the others
  std::filesystem::path states;
  std::filesystem::path events;
  std::filesystem::path timings;
  double fps = 30;  ///< Hz, of the recording
  uint64_t seed = 1;
  bool paper = false;                  ///< the paper's algorithm by its equations
  std::string paper_colour = "input";  ///< how colour takes part in it: see cures.h
  std::vector<std::string> without;    ///< cures of the full mode that are left out: see cures.h
  bool initial_poses_from_gt = false;  ///< scene_gt.json's poses of the first frame are suggested to the filter
  bool realtime = false;               ///< drops frames as a live camera would: not reproducible
  std::function<void(const PartPoses&)> observe;  ///< called with what the tracker says of each frame; may be empty
};

struct SequenceSummary {
  int frames = 0;                                ///< tracked
  int dropped = 0;                               ///< by --realtime
  int events = 0;                                ///< connections, mistakes, disconnections
  double detector_median = 0, detector_p99 = 0;  ///< s of processor time a frame, decoding not included
  double filter_median = 0, filter_p99 = 0;
};

/// @throws std::runtime_error or ConfigurationError naming the file that is wrong.
SequenceSummary TrackSequence(const SequenceOptions& options);

/// Every variant of the trackers together, frames read and parts detected once for all: the paper's mode with each use
/// of colour, the full mode, and the full mode without each of its cures. Writes NAME_poses.csv, NAME_states.csv,
/// NAME_events.csv and NAME_timings.csv into `folder`; NAME is paper, paper-observation, full, full-without-links and
/// so on.
void TrackVariants(const SequenceOptions& options, const std::filesystem::path& folder);

}  // namespace coach
