// Things above the table that are no part: hands, sleeves, what a hand holds.
#pragma once

#include <vector>

#include "common/assembly/part_poses.h"
#include "services/pose_filter/observation.h"
#include "services/pose_filter/owner_map.h"
#include "services/pose_filter/table_area.h"

namespace coach {

struct ForeignOptions {
  int grid = 8;           ///< px
  double lowest = 0.015;  ///< m above the table
  double highest = 0.45;  ///< m
  int least_cells = 12;
  double depth_step = 0.05;  ///< m; neighbours farther apart belong to different things
  int most = 4;
};

/// Finds them in each frame and follows their centres. Only what is over the table counts, so
/// that the child's body behind the table is none.
class ForeignFinder {
 public:
  explicit ForeignFinder(const ForeignOptions& options = {}) : options_(options) {}

  void Find(const Observation& observation, const OwnerMap& owners, const Pose& X_TC, const TableArea& area, double dt);
  const std::vector<ForeignBlob>& blobs() const { return blobs_; }  ///< of the last frame, largest first
  /// Distance (m) of the nearest foreign surface of the last frame to a point of the table frame; 10 if there is none.
  double Nearest(const Vector3& p_T) const;
  void Reset() { *this = ForeignFinder(options_); }

 private:
  struct Cell {
    Vector3 p_T;
    bool foreign = false;
  };
  ForeignOptions options_;
  std::vector<Cell> cells_;
  std::vector<int> stack_;
  std::vector<Vector3> points_;
  std::vector<ForeignBlob> blobs_, previous_;
};

}  // namespace coach
