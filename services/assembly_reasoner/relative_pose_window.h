// What a stretch of measurements says of the relative pose of two parts: a robust mean over the longest recent window
// in which it did not change, with the covariance of that mean.
//
// A tracker's errors are correlated in time, sometimes frozen, sometimes a jump of a few frames. So: medians and
// trimmed means (a jump shorter than half the window changes nothing), repeated values are no new evidence, n
// measurements count as their mean's variance under exponentially correlated errors says, and the spread seen overrides
// a covariance that is too small.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "common/geometry/pose.h"

namespace coach {

struct RelativePoseWindowOptions {
  double correlation_time = 0.15;   ///< s, of the tracker's errors
  double shortest = 0.15;           ///< s, first window tried; each next one is 20 % longer
  double longest = 2.4;             ///< s
  double history = 8.0;             ///< s, kept for dating a change
  double change_position = 0.0015;  ///< m, difference of two parts of a window that is no change
  double change_angle = 0.015;      ///< rad, the same
  double change_sigmas = 3.0;       ///< and in standard deviations of the two medians
};

struct RelativePoseSample {
  int64_t utime = 0;  ///< us
  Pose X_AB = Pose::Identity();
  Matrix6 covariance = Matrix6::Identity();  ///< of Perturb(X_AB, .)
  double travel = 0;                         ///< m, of A in the table frame over the last 0.5 s
  double turn = 0;                           ///< rad, the same
  double visible = 1;                        ///< 0..1, of the part that is seen less
};

struct RelativePoseEstimate {
  Pose X_AB = Pose::Identity();
  Matrix6 covariance = Matrix6::Identity();
  double constant_for = 0;  ///< s, length of the window
  double travel = 0;        ///< m, largest motion of A within half a second inside the window
  double turn = 0;          ///< rad
};

class RelativePoseWindow {
 public:
  explicit RelativePoseWindow(const RelativePoseWindowOptions& options = {}) : options_(options) {}

  /// Samples come in the order of time. A sample whose pose equals the last one exactly, or with a covariance that is
  /// not finite or not positive, is dropped.
  void Add(const RelativePoseSample& sample);
  /// Nothing if there is no sample within `shortest` before now.
  std::optional<RelativePoseEstimate> Estimate(int64_t now) const;

  /// All samples of the history, oldest first.
  const std::deque<RelativePoseSample>& samples() const { return samples_; }
  /// The pair seen from the other part: X_BA.
  void Reverse();

 private:
  /// Whether the first `split` of the values differ from the others by more than their errors over a time of `spans`
  /// correlation times explain.
  bool Changed(const std::vector<Vector6>& x, size_t split, const Matrix6& covariance, double spans) const;

  RelativePoseWindowOptions options_;
  std::deque<RelativePoseSample> samples_;
};

}  // namespace coach
