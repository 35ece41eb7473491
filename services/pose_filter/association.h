// Which region is which part, and how far to trust it: the paper's stage 1, second half.
#pragma once

#include <optional>
#include <vector>

#include "common/assembly/detections.h"
#include "common/assembly/task.h"

namespace coach {

/// Assigns rows to columns so that the sum of costs is least (Hungarian method with potentials, O(n^3)).
/// @param cost rows x columns, row by row, finite.
/// @returns for each row its column, or -1 (only if there are more rows than columns).
std::vector<int> SolveAssignment(int rows, int columns, const std::vector<double>& cost);

struct RegionOfPart {
  int region = -1;        ///< index into Detections::regions; -1: none
  double confidence = 0;  ///< s_k of [4]: A_k / (A_k + areas of the class's regions that are assigned to no part)
};

/// The paper's assignment, for each colour class by itself. One part in the class: the largest region. N parts: the N
/// largest regions (or all, if fewer) to the parts at the least sum of distances from where the parts are expected.
/// @param expected pixel of each part; empty if it was never seen (it takes what the others leave).
std::vector<RegionOfPart> AssignRegions(const Task& task, const Detections& detections,
                                        const std::vector<std::optional<Eigen::Vector2d>>& expected);

}  // namespace coach
