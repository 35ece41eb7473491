#include "tools/simulator/motion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace coach {

double MinimumJerk(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}

Pose OnTable(double x, double y, double z, double yaw) {
  return MakePose(Eigen::AngleAxisd(yaw, Vector3::UnitZ()).toRotationMatrix(), Vector3(x, y, z));
}

Pose PoseDuring(const ThingSegment& s, double time) {
  const double linear = s.end > s.start ? std::clamp((time - s.start) / (s.end - s.start), 0.0, 1.0) : 1.0;
  // A lifted thing goes up first, across and then down, each movement running into the next.
  const double progress = s.lift > 0 ? MinimumJerk((linear - 0.2) / 0.6) : MinimumJerk(linear);
  const Vector3 turn = LogRotation(s.to.linear() * s.from.linear().transpose());
  Vector3 p = s.from.translation() + progress * (s.to.translation() - s.from.translation());
  p.z() += s.lift * (MinimumJerk(linear / 0.35) - MinimumJerk((linear - 0.65) / 0.35));
  return MakePose(ExpRotation(progress * turn) * s.from.linear(), p);
}

ThingTracks::ThingTracks(std::vector<Pose> at_start) : at_start_(std::move(at_start)), tracks_(at_start_.size()) {}

void ThingTracks::Add(int thing, const ThingSegment& segment) {
  auto& track = tracks_.at(static_cast<size_t>(thing));
  if (!track.empty() && segment.start < track.back().start) throw std::invalid_argument("track: segment out of order");
  track.push_back(segment);
}

Pose ThingTracks::At(int thing, double time) const {
  const auto& track = tracks_.at(static_cast<size_t>(thing));
  const int index = LastStarted(track, time);
  if (index < 0) return at_start_[static_cast<size_t>(thing)];
  const ThingSegment& s = track[static_cast<size_t>(index)];
  return s.carrier >= 0 ? At(s.carrier, time) * s.X_carrier_thing : PoseDuring(s, time);
}

}  // namespace coach
