#include "services/pose_filter/table_area.h"

#include <algorithm>

namespace coach {

void TableArea::Add(const Observation& o, const Pose& X_TC) {
  if (!o.depth || !o.has_table) return;
  for (int y = 4; y < o.camera.height; y += 8) {
    for (int x = 4; x < o.camera.width; x += 8) {
      const double z = o.Depth(x, y);
      if (z == 0 || !o.OnTable(x, y, z)) continue;
      const Vector3 p = X_TC * Vector3((x - o.camera.cx) / o.camera.fx * z, (y - o.camera.cy) / o.camera.fy * z, z);
      const int i = Index(p.x()), j = Index(p.y());
      if (i < 0 || j < 0 || i >= kCells || j >= kCells) continue;
      uint16_t& n = count_[static_cast<size_t>(j) * kCells + i];
      n = static_cast<uint16_t>(std::min<int>(n + 1, 60000));
    }
  }
  // Walls cross the table's plane in thin lines, so what is far and apart from the middle does not count.
  over_.fill(false);
  std::array<bool, kCells * kCells> reached{};
  stack_.clear();
  for (int j = kCells / 2 - 4; j < kCells / 2 + 4; ++j) {
    for (int i = kCells / 2 - 4; i < kCells / 2 + 4; ++i) {
      const int cell = j * kCells + i;
      if (count_[static_cast<size_t>(cell)] >= 2) {
        reached[static_cast<size_t>(cell)] = true;
        stack_.push_back(cell);
      }
    }
  }
  while (!stack_.empty()) {
    const int cell = stack_.back();
    stack_.pop_back();
    known_ = true;
    const int ci = cell % kCells, cj = cell / kCells;
    for (int dj = -kMargin; dj <= kMargin; ++dj) {
      for (int di = -kMargin; di <= kMargin; ++di) {
        const int i = ci + di, j = cj + dj;
        if (i < 0 || j < 0 || i >= kCells || j >= kCells) continue;
        const auto next = static_cast<size_t>(j) * kCells + i;
        over_[next] = true;
        if (std::abs(di) <= 1 && std::abs(dj) <= 1 && !reached[next] && count_[next] >= 2) {
          reached[next] = true;
          stack_.push_back(static_cast<int>(next));
        }
      }
    }
  }
}

bool TableArea::Over(const Vector3& p_T) const {
  if (!known_) return true;
  const int i = Index(p_T.x()), j = Index(p_T.y());
  return i >= 0 && j >= 0 && i < kCells && j < kCells && over_[static_cast<size_t>(j) * kCells + i];
}

}  // namespace coach
