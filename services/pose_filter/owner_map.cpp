#include "services/pose_filter/owner_map.h"

#include <algorithm>

namespace coach {

void OwnerMap::Resize(const CameraModel& camera) {
  width_ = (camera.width + kStep - 1) / kStep;
  height_ = (camera.height + kStep - 1) / kStep;
  cells_.assign(static_cast<size_t>(width_) * height_, Cell{});
}

void OwnerMap::Clear() { std::fill(cells_.begin(), cells_.end(), Cell{}); }

void OwnerMap::Add(int part, const DepthTile& tile) {
  for (int j = 0; j < tile.height; ++j) {
    Cell* row = &cells_[static_cast<size_t>(tile.y0 / kStep + j) * width_ + tile.x0 / kStep];
    for (int i = 0; i < tile.width; ++i) {
      const float d = tile.At(i, j);
      if (d == 0) continue;
      Cell& c = row[i];
      if (c.depth[0] == 0 || d < c.depth[0]) {
        c.depth[1] = c.depth[0];
        c.owner[1] = c.owner[0];
        c.depth[0] = d;
        c.owner[0] = static_cast<int16_t>(part);
      } else if (c.depth[1] == 0 || d < c.depth[1]) {
        c.depth[1] = d;
        c.owner[1] = static_cast<int16_t>(part);
      }
    }
  }
}

void OwnerMap::Remove(int part, const DepthTile& tile) {
  for (int j = 0; j < tile.height; ++j) {
    Cell* row = &cells_[static_cast<size_t>(tile.y0 / kStep + j) * width_ + tile.x0 / kStep];
    for (int i = 0; i < tile.width; ++i) {
      Cell& c = row[i];
      if (c.owner[0] == part) {
        c.owner[0] = c.owner[1];
        c.depth[0] = c.depth[1];
      }
      if (c.owner[0] == part || c.owner[1] == part || c.owner[0] == c.owner[1]) {
        c.owner[1] = -1;
        c.depth[1] = 0;
      }
    }
  }
}

}  // namespace coach
