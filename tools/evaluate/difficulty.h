// How hard a scene is: what is hidden, how fast, how noisy.
#pragma once

#include <string>
#include <vector>

#include "tools/evaluate/pose_scores.h"

namespace coach {

struct Difficulty {
  std::string name;
  int frames = 0, parts = 0;
  double seconds = 0;
  double mean_visible = 0;                             ///< share of the silhouette, 0..1
  double under_half = 0, under_tenth = 0, hidden = 0;  ///< % of part-frames under 0.5, 0.1, 0.05 visible
  Statistics speed;           ///< m/s in the camera frame, of part-frames that move at over 0.02 m/s
  double turning_p95 = 0;     ///< degrees a second, of the same
  double depth_noise_mm = 0;  ///< standard deviation in time of still pixels
  double depth_missing = 0;   ///< % of pixels
  double colour_noise = 0;    ///< of 255, the same
};

/// Reads at most 30 pairs of neighbouring frames for the noise.
Difficulty MeasureDifficulty(const SceneTruth& truth);
std::string DifficultyTable(const std::vector<Difficulty>& scenes);

}  // namespace coach
