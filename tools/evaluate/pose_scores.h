// How good the poses of a scene are. The definitions are those of docs/results.md; times in s, lengths in mm, angles
// in degrees, like the result files.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "tools/evaluate/estimates.h"

namespace coach {

struct Statistics {
  int n = 0;
  double median = 0, p95 = 0, mean = 0, max = 0;
};
/// Percentiles interpolate between neighbours. Nothing to say of no values: n = 0.
Statistics Summarise(std::vector<double> values);

/// Linear interpolation between the sorted values; q in 0..1; 0 for no values.
double Quantile(std::vector<double> values, double q);

inline constexpr double kNoEstimate = std::numeric_limits<double>::infinity();

/// Errors of every part in every frame, [part][frame]; kNoEstimate where there is none.
struct PoseErrors {
  std::vector<std::vector<double>> position_mm, rotation_deg;
  std::vector<int> slot;  ///< by part: the estimate's slot, fixed for the whole scene
};

/// Equal parts are named once: by the assignment that fits best in the first second in which all of a kind are seen.
PoseErrors ComputeErrors(const SceneTruth& truth, const Estimates& estimates);

struct Loss {
  int part = 0;
  double from = 0, to = 0;  ///< s
};
struct Recovery {
  int part = 0;
  double visible_at = 0;        ///< s, at least 0.3 visible for the third frame
  std::optional<double> after;  ///< s until the error stays under 10 mm for 3 frames
};

struct PoseScores {
  Statistics position_mm, rotation_deg;              ///< at least 0.1 visible
  Statistics add_s_mm;                               ///< the same
  Statistics clear_position_mm, clear_rotation_deg;  ///< at least 0.5 visible
  double success_10 = 0, success_30 = 0;  ///< % of part-frames at least 0.1 / 0.3 visible within 20 mm and 10 degrees
  double estimated = 0;                   ///< % of part-frames at least 0.1 visible with an estimate
  std::vector<Loss> losses;               ///< over 50 mm or none for 3 visible frames
  double lost_seconds = 0;
  std::vector<Recovery> recoveries;           ///< after at least 0.3 s under 0.05 visible
  int identity_switches = 0;                  ///< changes of the assignment of equal parts that fits best
  double longest_swap = 0;                    ///< s in which two equal parts are each nearer to the other's place
  std::optional<double> start_seconds;        ///< until all visible parts are within 20 mm and 10 degrees
  Statistics distance_mm;                     ///< |distance of parts 0 and 1 - true|, both at least 0.5 visible
  Statistics distance_all_mm;                 ///< the same in all frames with estimates
  std::optional<double> wrong_while_tracked;  ///< % of `tracked` part-frames off by over 20 mm
  std::optional<double> coverage_visible, coverage_hidden;  ///< % of part-frames in the 95 % position ellipsoid
  int tracked_frames = 0;
};
PoseScores ScorePoses(const SceneTruth& truth, const Estimates& estimates, const PoseErrors& errors);

/// How many of the recoveries took 0.2 s at most.
int Recovered(const PoseScores& scores);

/// |distance between parts 0 and 1 - the true one| by frame, mm; kNoEstimate where one has no estimate.
std::vector<double> DistanceErrors(const SceneTruth& truth, const Estimates& estimates, const PoseErrors& errors);

}  // namespace coach
