#include "tools/simulator/performance.h"

#include <algorithm>
#include <cmath>

namespace coach {

HandPose Performance::HandAt(Side side, double time) const {
  const size_t i = static_cast<size_t>(side);
  const int index = LastStarted(hands[i], time);
  if (index < 0) return hands_at_start[i];
  const HandSegment& s = hands[i][static_cast<size_t>(index)];
  const double linear = s.end > s.start ? std::clamp((time - s.start) / (s.end - s.start), 0.0, 1.0) : 1.0;
  const double progress = MinimumJerk(linear);
  HandPose pose = Between(s.from, s.to, progress);
  if (s.thing >= 0) {
    pose.p_W = things.At(s.thing, time) * s.p_thing;
  } else {
    pose.p_W.z() += s.lift * std::pow(std::sin(M_PI * progress), 2);
  }
  return pose;
}

}  // namespace coach
