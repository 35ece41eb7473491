// The table: a plane in the camera frame, and the table frame built on it.
#pragma once

#include <optional>
#include <vector>

#include "common/geometry/pose.h"
#include "services/pose_filter/observation.h"

namespace coach {

struct TableFit {
  Plane plane;
  int inliers = 0;      ///< samples of the grid on the plane
  int samples = 0;      ///< samples with a reading
  double residual = 0;  ///< m, median absolute distance of the inliers
};

struct TableOptions {
  int grid = 8;               ///< px between samples
  int hypotheses = 300;       ///< RANSAC triples
  double least_share = 0.10;  ///< of the samples with a reading must lie on the table
};

/// Finds the table from nothing: the plane with the most support, where support counts readings near it once and those
/// of the parts' colours just above it five times over, so that a wall does not win. Empty if no plane has enough
/// support.
std::optional<TableFit> FindTable(const Observation& observation, uint64_t seed, const TableOptions& options = {});

/// Least squares around a known plane (three robust rounds). Empty if too little of it is seen.
std::optional<TableFit> RefineTable(const Observation& observation, const Plane& prior,
                                    const TableOptions& options = {});

/// The table frame: z up along the normal, origin where the camera's axis meets the table (or its foot point if it does
/// not), x the camera's x axis projected.
Pose TableFrame(const Plane& plane);

/// The plane z = 0 of T, in camera frame.
Plane PlaneOf(const Pose& X_TC);

}  // namespace coach
