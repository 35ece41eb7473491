// The child's body as round segments: hands with fingers, arms, trunk, head.
#pragma once

#include <array>
#include <vector>

#include "common/geometry/pose.h"
#include "tools/simulator/ray_tracer.h"

namespace coach {

enum class Side { kLeft = 0, kRight = 1 };

/// A hand. H is its frame: origin between the tips of thumb and fingers, x from the wrist forward (horizontal), z up.
struct HandPose {
  Vector3 p_W = Vector3::Zero();  ///< m, origin of H
  double yaw = 0;                 ///< rad, direction of x about the table's normal; 0: world x
  double spread = 0.05;           ///< m between the tips of thumb and fingers
  double across = 1;  ///< 1: thumb and fingers close sideways (y); 0: along x, the thumb nearer to the wrist
  double flat = 0;    ///< 0 pinching .. 1 flat with the fingers spread, as for covering
};

/// The pose between two (0..1); yaw the short way.
HandPose Between(const HandPose& a, const HandPose& b, double progress);

struct BodyShape {
  double size = 1;           ///< 1: about eight years old
  Vector3 seat{0, 0.56, 0};  ///< m, middle of the hips' height above the table's plane
  double sleeve = 0.75;      ///< share of the arm that is covered, from the shoulder
};

/// What is seen of the child, by material.
struct BodySegments {
  std::vector<RoundSegment> skin, clothes, hair;
};

/// @param hands left, right (the child's own).
BodySegments PoseBody(const BodyShape& shape, const std::array<HandPose, 2>& hands);

}  // namespace coach
