// How hands and what they carry move: minimum-jerk paths over the table.
#pragma once

#include <vector>

#include "common/geometry/pose.h"

namespace coach {

/// Progress 0..1 of a minimum-jerk movement at s = (t - t0) / (t1 - t0), clamped (Flash and Hogan 1985).
double MinimumJerk(double s);

/// Turn about the table's normal by `yaw` rad, then shift.
Pose OnTable(double x, double y, double z, double yaw);

/// What a thing does from `start` until its next segment starts.
struct ThingSegment {
  double start = 0, end = 0;  ///< s; from `end` on it stays at `to`
  Pose from = Pose::Identity(), to = Pose::Identity();
  double lift = 0;   ///< m, by which it is lifted over what lies between
  int carrier = -1;  ///< another thing: it moves rigidly with it, at X_carrier_thing
  Pose X_carrier_thing = Pose::Identity();
};

/// Pose of a thing without carrier at a time (s); before the start `from`, after the end `to`.
Pose PoseDuring(const ThingSegment& segment, double time);

/// Where things are at any time. Things are numbered by the caller.
class ThingTracks {
 public:
  explicit ThingTracks(std::vector<Pose> at_start);
  int size() const { return static_cast<int>(tracks_.size()); }

  /// Segments of a thing must be added in the order of their start.
  void Add(int thing, const ThingSegment& segment);
  Pose At(int thing, double time) const;

 private:
  std::vector<Pose> at_start_;
  std::vector<std::vector<ThingSegment>> tracks_;
};

/// The index of the last segment that has started, -1 if none. Segments have a field `start`.
template <class Segment>
int LastStarted(const std::vector<Segment>& segments, double time) {
  int index = static_cast<int>(segments.size()) - 1;
  while (index >= 0 && segments[static_cast<size_t>(index)].start > time) --index;
  return index;
}

}  // namespace coach
