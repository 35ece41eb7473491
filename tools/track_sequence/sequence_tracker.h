// Runs detector, filter and reasoner over a recorded scene, lockstep, through the libraries that the services run.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"

namespace coach {

struct SequenceOptions {
  std::filesystem::path scene;    ///< scene folder
  std::filesystem::path task;     ///< task file
  std::filesystem::path poses;    ///< results to write; empty: not written; so are the others
  std::filesystem::path states;
  std::filesystem::path events;
  std::filesystem::path timings;
  double fps = 30;                ///< Hz, of the recording
  uint64_t seed = 1;
  bool paper = false;             ///< the paper's algorithm by its equations
  bool initial_poses_from_gt = false;  ///< scene_gt.json's poses of the first frame are suggested to the filter
  bool realtime = false;          ///< drops frames as a live camera would: not reproducible
  std::function<void(const PartPoses&)> observe;  ///< called with what the tracker says of each frame; may be empty
};

struct SequenceSummary {
  int frames = 0;        ///< tracked
  int dropped = 0;       ///< by --realtime
  int events = 0;        ///< connections, mistakes, disconnections
  double detector_median = 0, detector_p99 = 0;  ///< s of processor time a frame, decoding not included
  double filter_median = 0, filter_p99 = 0;
};

/// @throws std::runtime_error or ConfigurationError naming the file that is wrong.
SequenceSummary TrackSequence(const SequenceOptions& options);

}  // namespace coach
