// All that happens in a simulated lesson, as functions of time: things, hands, events.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tools/simulator/body.h"
#include "tools/simulator/motion.h"

namespace coach {

/// A true event. Kinds: grasp, release, connect, wrong_connect, disconnect, near_miss_start, near_miss_end,
/// cover_start, cover_end, handed_over, jolt; and what the images show: occlusion_start, occlusion_end (level),
/// out_of_view, in_view.
struct TrueEvent {
  double time = 0;  ///< s
  std::string kind{};
  std::vector<int> parts{};
  std::string connection{};  ///< name, if it is one
  std::string hand{};        ///< left, right, or empty
  std::string level{};       ///< partial, full, or empty
  double duration = 0;       ///< s, of a jolt
  double shift = 0;          ///< m, of a jolt
  double turn = 0;           ///< rad, of a jolt
};

struct HandSegment {
  double start = 0, end = 0;  ///< s; from `end` on it stays at `to`
  HandPose from, to;
  double lift = 0;  ///< m
  int thing = -1;   ///< held thing: the hand's point is at p_thing of it
  Vector3 p_thing = Vector3::Zero();
};

struct Performance {
  explicit Performance(std::vector<Pose> things_at_start, const std::array<HandPose, 2>& resting)
      : things(std::move(things_at_start)), hands_at_start(resting) {}

  HandPose HandAt(Side side, double time) const;

  ThingTracks things;  ///< the task's parts, then other movable things
  std::array<HandPose, 2> hands_at_start;
  std::array<std::vector<HandSegment>, 2> hands;
  std::vector<TrueEvent> events;
};

}  // namespace coach
