// What the images alone say about two parts near each other. Only free fits take part: no pose that a connection was
// imposed on.
#pragma once

#include <vector>

#include "common/assembly/part_poses.h"
#include "common/assembly/task.h"
#include "common/geometry/distance_field.h"
#include "services/pose_filter/part_track.h"

namespace coach {

struct PairOptions {
  double near = 0.030;             ///< m between two surfaces for a pair to be reported
  double window = 0.5;             ///< s over which motion is measured
  double floor_position = 0.0010;  ///< m, errors that two free fits do not share and no covariance shows
  double floor_rotation = 0.012;   ///< rad
  double open_volume = 0.08 * 0.08 * 0.08 * 79.0;  ///< m^3 rad^3 that two free parts in contact spread over
};

/// Finds the pairs of a frame. Keeps the last half second of poses for their motion.
class PairFinder {
 public:
  PairFinder(const Task& task, const PairOptions& options = {});

  /// A joint that two types can be in: relative pose and where it comes from.
  struct Candidate {
    Pose X_AB;
    CandidateKind kind;
    int index;
  };
  /// Every joint of two parts with its symmetric equivalents, in the first one's frame.
  const std::vector<Candidate>& CandidatesOf(int part_a, int part_b) const {
    return candidates_[static_cast<size_t>(task_.parts[part_a].type) * task_.types.size() + task_.parts[part_b].type];
  }

  /// Share of a's surface that lies deeper than `allowed` (m) inside b, 0..1.
  double Overlap(int part_a, const Pose& X_TA, int part_b, const Pose& X_TB, double allowed) const;

  /// @param tracks of this frame, in the order of Task::parts. @param out is overwritten
  void Find(int64_t utime, const std::vector<Track>& tracks, std::vector<PairEvidence>& out);
  void Reset() { history_.clear(); }

 private:
  struct Moment {
    int64_t utime = 0;
    std::vector<Pose> X_TP;
    std::vector<bool> seen;
  };
  void Motion(PairEvidence& pair, const Moment& now) const;
  void TestCandidates(PairEvidence& pair) const;

  const Task task_;
  PairOptions options_;
  std::vector<DistanceField> fields_;               // one a type
  std::vector<std::vector<SurfacePoint>> surface_;  // one a type
  std::vector<MeshExtent> extents_;
  std::vector<std::vector<Candidate>> candidates_;  // of types a * T + b, symmetric equivalents written out
  std::vector<Moment> history_;                     // oldest first
};

}  // namespace coach
