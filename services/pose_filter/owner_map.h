// Which parts the filter believes to be where in the image: for each cell the two nearest.
#pragma once

#include <vector>

#include "services/pose_filter/depth_tile.h"

namespace coach {

/// A grid over the image with one cell every kStep pixels. Built once a frame from the parts' predicted tiles; lets one
/// part ask what the OTHERS put in front of it without rendering them again.
class OwnerMap {
 public:
  static constexpr int kStep = 2;  ///< px

  struct Cell {
    float depth[2] = {0, 0};  ///< m, nearest first; 0: none
    int16_t owner[2] = {-1, -1};
  };

  void Resize(const CameraModel& camera);
  void Clear();
  /// Adds a part's tile; its step must be kStep.
  void Add(int part, const DepthTile& tile);
  /// Removes one part's contribution inside its former tile.
  void Remove(int part, const DepthTile& tile);

  /// Depth of the nearest OTHER part at a pixel; 0: none.
  float OtherDepth(int x, int y, int part) const {
    const Cell& c = At(x, y);
    return c.owner[0] == part ? c.depth[1] : c.depth[0];
  }
  int OtherOwner(int x, int y, int part) const {
    const Cell& c = At(x, y);
    return c.owner[0] == part ? c.owner[1] : c.owner[0];
  }
  int Owner(int x, int y) const { return At(x, y).owner[0]; }
  float NearestDepth(int x, int y) const { return At(x, y).depth[0]; }

 private:
  const Cell& At(int x, int y) const { return cells_[static_cast<size_t>(y / kStep) * width_ + x / kStep]; }
  int width_ = 0, height_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace coach
