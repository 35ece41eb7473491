// Round segments as triangles, so that rays meet arms and fingers as fast as boxes.
#pragma once

#include <array>
#include <vector>

#include "common/geometry/pose.h"

namespace coach {

/// A cone with rounded ends: what arms and fingers are made of. World frame, m.
struct RoundSegment {
  Vector3 a = Vector3::Zero(), b = Vector3::Zero();
  double radius_a = 0.01, radius_b = 0.01;
};

inline constexpr int kLimbVertices = 74, kLimbTriangles = 144;  ///< of one segment

/// The triangles of one segment: indices of its own kLimbVertices vertices. The same for every segment.
const std::vector<std::array<unsigned, 3>>& LimbTriangles();

/// Writes the 3 * kLimbVertices coordinates of a segment. They lie off the round surface by at most 1.7 % of the
/// radius, as often outside as inside.
void WriteLimbVertices(const RoundSegment& segment, float* xyz);

/// The unit normal of the round surface near p; a cone's slope is neglected.
Eigen::Vector3f LimbNormal(const RoundSegment& segment, const Eigen::Vector3f& p);

}  // namespace coach
