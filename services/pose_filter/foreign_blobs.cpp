#include "services/pose_filter/foreign_blobs.h"

#include <algorithm>
#include <cmath>

namespace coach {

void ForeignFinder::Find(const Observation& o, const OwnerMap& owners, const Pose& X_TC, const TableArea& area,
                         double dt) {
  std::swap(blobs_, previous_);
  blobs_.clear();
  points_.clear();
  if (!o.depth || !o.has_table) return;
  const int width = o.camera.width / options_.grid, height = o.camera.height / options_.grid;
  cells_.assign(static_cast<size_t>(width) * height, Cell{});
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const int x = i * options_.grid + options_.grid / 2, y = j * options_.grid + options_.grid / 2;
      const double z = o.Depth(x, y);
      if (z == 0) continue;
      const Vector3 p_T = X_TC * Vector3((x - o.camera.cx) / o.camera.fx * z, (y - o.camera.cy) / o.camera.fy * z, z);
      if (p_T.z() < options_.lowest || p_T.z() > options_.highest || !area.Over(p_T)) continue;
      if (owners.Owner(x, y) >= 0 && std::abs(owners.NearestDepth(x, y) - z) < 0.03) continue;
      if (o.Classes(x, y) != 0) continue;
      cells_[static_cast<size_t>(j) * width + i] = {p_T, true};
      points_.push_back(p_T);
    }
  }
  for (int start = 0; start < width * height; ++start) {
    if (!cells_[static_cast<size_t>(start)].foreign) continue;
    cells_[static_cast<size_t>(start)].foreign = false;
    stack_.assign(1, start);
    Vector3 sum = Vector3::Zero();
    double square = 0;
    int n = 0;
    while (!stack_.empty()) {
      const int cell = stack_.back();
      stack_.pop_back();
      const Vector3& p = cells_[static_cast<size_t>(cell)].p_T;
      sum += p;
      square += p.squaredNorm();
      ++n;
      for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const int i = cell % width + di, j = cell / width + dj;
        if (i < 0 || j < 0 || i >= width || j >= height) continue;
        Cell& next = cells_[static_cast<size_t>(j) * width + i];
        if (!next.foreign || (next.p_T - p).norm() > options_.depth_step) continue;
        next.foreign = false;
        stack_.push_back(j * width + i);
      }
    }
    if (n < options_.least_cells) continue;
    ForeignBlob blob;
    blob.centre = sum / n;
    blob.radius = 1.5 * std::sqrt(std::max(0.0, square / n - blob.centre.squaredNorm()));
    blobs_.push_back(blob);
  }
  std::stable_sort(blobs_.begin(), blobs_.end(),
                   [](const ForeignBlob& a, const ForeignBlob& b) { return a.radius > b.radius; });
  if (static_cast<int>(blobs_.size()) > options_.most) blobs_.resize(static_cast<size_t>(options_.most));
  for (ForeignBlob& blob : blobs_) {
    const ForeignBlob* nearest = nullptr;
    for (const ForeignBlob& p : previous_) {
      if (!nearest || (p.centre - blob.centre).norm() < (nearest->centre - blob.centre).norm()) nearest = &p;
    }
    if (nearest && (nearest->centre - blob.centre).norm() < 0.2 && dt > 0)
      blob.velocity = 0.5 * nearest->velocity + 0.5 * (blob.centre - nearest->centre) / dt;
  }
}

double ForeignFinder::Nearest(const Vector3& p_T) const {
  double best = 10;
  for (const Vector3& p : points_) best = std::min(best, (p - p_T).norm());
  return best;
}

}  // namespace coach
