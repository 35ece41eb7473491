// The paper's probability that two parts are connected, from their poses alone.
//
// "Object Assembly Guidance in Child-Robot Interaction using RGB-D based 3D Tracking", equations [1] and [2].
#pragma once

#include "common/assembly/task.h"
#include "common/geometry/pose.h"

namespace coach {

struct ConnectionProbabilityOptions {
  double alpha = 0.04;  ///< m, up to this error the probability is 1
  double beta = 0.08;   ///< m, from this error on it is 0
};

/// [2]: d(x, y) = min(1, max(0, (|x - y| - beta) / (alpha - beta))).
double DistanceProbability(const Vector3& x, const Vector3& y, const ConnectionProbabilityOptions& options = {});

/// [1]: half d(desired, estimated position of B in A) + half d(desired, estimated position of A in B).
/// @param X_AB_desired relative pose of the connection
/// @param X_AB relative pose as estimated
double PaperConnectionProbability(const Pose& X_AB_desired, const Pose& X_AB,
                                  const ConnectionProbabilityOptions& options = {});

/// The same, the largest over the symmetries of the two parts (a deviation from the paper, which has none: a symmetric
/// part's estimated orientation is arbitrary within them).
double PaperConnectionProbability(const SymmetryGroup& a, const SymmetryGroup& b, const Pose& X_AB_desired,
                                  const Pose& X_AB, const ConnectionProbabilityOptions& options = {});

}  // namespace coach
