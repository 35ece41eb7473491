// Symmetries of a rigid part: the rotations of the part onto itself.
#pragma once

#include <vector>

#include "common/geometry/pose.h"

namespace coach {

/// Symmetries about the part's origin. X_AP and X_AP * S look the same for every S of the group.
struct SymmetryGroup {
  /// The closed group of discrete rotations; identity first. Never empty.
  std::vector<Matrix3> discrete{Matrix3::Identity()};
  /// Unit axes (part frame) of free rotation. More than one: a sphere.
  std::vector<Vector3> axes;

  bool trivial() const { return discrete.size() == 1 && axes.empty(); }
};

/// Closes a set of rotations under multiplication (identity is added).
/// @throws std::invalid_argument if a matrix is no rotation (1e-3), an axis has no length, or the closure has over 240
/// elements.
SymmetryGroup MakeSymmetryGroup(const std::vector<Matrix3>& discrete, const std::vector<Vector3>& axes);

/// The pose equivalent to X_AP whose rotation is nearest to that of `reference`. For a free axis the nearest angle is
/// exact.
Pose NearestEquivalent(const SymmetryGroup& group, const Pose& X_AP, const Pose& reference);

/// Smallest rotation (rad) between X and an equivalent of Y.
double RotationError(const SymmetryGroup& group, const Matrix3& X, const Matrix3& Y);

/// The group as a finite list: the discrete elements, each combined with rotations about the free axes every `step`
/// radians.
std::vector<Matrix3> SampledElements(const SymmetryGroup& group, double step);

}  // namespace coach
