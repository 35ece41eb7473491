#include "services/pose_filter/blobs.h"

#include <algorithm>
#include <cmath>

namespace coach {

const std::vector<Blob>& BlobFinder::FindUnexplained(const Observation& o, const OwnerMap& owners,
                                                     const std::vector<int>& class_of_part, int num_classes,
                                                     const Pose& X_TC, const TableArea& area) {
  blobs_.clear();
  if (!o.class_map) return blobs_;
  constexpr int kStep = Blob::kStep;
  Resize(o.camera);
  for (int j = 0; j < height_; ++j) {
    const int y = j * kStep + kStep / 2;
    for (int i = 0; i < width_; ++i) {
      const int x = i * kStep + kStep / 2;
      uint8_t classes = o.Classes(x, y);
      if (classes == 0) continue;
      const float z = o.Depth(x, y);
      if (z > 0) {
        if (z > options_.farthest) continue;
        const Vector3 p_T = X_TC * Vector3((x - o.camera.cx) / o.camera.fx * z, (y - o.camera.cy) / o.camera.fy * z, z);
        if (p_T.z() < options_.lowest || p_T.z() > options_.highest || !area.Over(p_T)) continue;
      }
      for (const int dx : {0, -kStep, kStep}) {
        for (const int dy : {0, -kStep, kStep}) {
          if (!o.Inside(x + dx, y + dy)) continue;
          const int owner = owners.Owner(x + dx, y + dy);
          // What is clearly in front of the part, or behind it beside its outline, is not the part.
          if (owner < 0 || (z > 0 && std::abs(z - owners.NearestDepth(x + dx, y + dy)) > 0.03)) continue;
          classes = static_cast<uint8_t>(classes & ~(1u << class_of_part[static_cast<size_t>(owner)]));
        }
      }
      const size_t cell = static_cast<size_t>(j) * width_ + i;
      open_[cell] = classes;
      depth_[cell] = z;
    }
  }
  for (int c = 0; c < num_classes; ++c) {
    for (int cell = 0; cell < width_ * height_; ++cell) {
      const auto bit = static_cast<uint8_t>(1u << c);
      if (!(open_[static_cast<size_t>(cell)] & bit)) continue;
      Blob blob;
      blob.colour_class = c;
      Flood(o, bit, options_.depth_step, cell, blob);
      if (blob.cells >= options_.least_cells) blobs_.push_back(std::move(blob));
    }
  }
  return blobs_;
}

const std::vector<Blob>& BlobFinder::FindSurfaces(const Observation& o, const OwnerMap& owners, const Pose& X_TC,
                                                  const TableArea& area) {
  blobs_.clear();
  if (!o.depth) return blobs_;
  constexpr int kStep = Blob::kStep;
  Resize(o.camera);
  for (int j = 0; j < height_; ++j) {
    const int y = j * kStep + kStep / 2;
    for (int i = 0; i < width_; ++i) {
      const int x = i * kStep + kStep / 2;
      const float z = o.Depth(x, y);
      if (z <= 0 || z > options_.farthest || owners.Owner(x, y) >= 0) continue;
      const Vector3 p_T = X_TC * Vector3((x - o.camera.cx) / o.camera.fx * z, (y - o.camera.cy) / o.camera.fy * z, z);
      if (p_T.z() < options_.surface_height || p_T.z() > options_.highest || !area.Over(p_T)) continue;
      const size_t cell = static_cast<size_t>(j) * width_ + i;
      open_[cell] = 1;
      depth_[cell] = z;
    }
  }
  for (int cell = 0; cell < width_ * height_; ++cell) {
    if (!open_[static_cast<size_t>(cell)]) continue;
    Blob blob;
    blob.colour_class = -1;
    Flood(o, 1, options_.surface_step, cell, blob);
    if (blob.cells >= options_.least_surface_cells) blobs_.push_back(std::move(blob));
  }
  return blobs_;
}

void BlobFinder::Resize(const CameraModel& camera) {
  width_ = camera.width / Blob::kStep;
  height_ = camera.height / Blob::kStep;
  open_.assign(static_cast<size_t>(width_) * height_, 0);
  depth_.assign(open_.size(), 0.0f);
}

void BlobFinder::Flood(const Observation& o, uint8_t bit, double depth_step, int start, Blob& blob) {
  Vector3 sum = Vector3::Zero();
  stack_.assign(1, start);
  open_[static_cast<size_t>(start)] &= static_cast<uint8_t>(~bit);
  while (!stack_.empty()) {
    const int cell = stack_.back();
    stack_.pop_back();
    const int i = cell % width_, j = cell / width_;
    const int x = i * Blob::kStep + Blob::kStep / 2, y = j * Blob::kStep + Blob::kStep / 2;
    ++blob.cells;
    blob.pixels.emplace_back(x, y);
    blob.centre += Eigen::Vector2d(x, y);
    blob.touches_border |= i <= 1 || j <= 1 || i >= width_ - 2 || j >= height_ - 2;
    const float z = depth_[static_cast<size_t>(cell)];
    if (z > 0) {
      sum += Vector3((x - o.camera.cx) / o.camera.fx * z, (y - o.camera.cy) / o.camera.fy * z, z);
      ++blob.readings;
    }
    for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}}) {
      const int ni = i + di, nj = j + dj;
      if (ni < 0 || nj < 0 || ni >= width_ || nj >= height_) continue;
      const int next = nj * width_ + ni;
      if (!(open_[static_cast<size_t>(next)] & bit)) continue;
      const float zn = depth_[static_cast<size_t>(next)];
      if (z > 0 && zn > 0 && std::abs(z - zn) > depth_step) continue;
      open_[static_cast<size_t>(next)] &= static_cast<uint8_t>(~bit);
      stack_.push_back(next);
    }
  }
  blob.centre /= blob.cells;
  if (blob.readings > 0) blob.p_C = sum / blob.readings;
}

void Distractors::Remember(const std::vector<Blob>& blobs, const Pose& X_TC) {
  for (Place& p : places_) --p.seen;
  for (const Blob& blob : blobs) {
    if (blob.readings == 0) continue;
    const Vector3 p_T = X_TC * blob.p_C;
    const auto same = std::find_if(places_.begin(), places_.end(), [&](const Place& p) {
      return p.colour_class == blob.colour_class && (p.p_T - p_T).norm() < 0.03;
    });
    if (same == places_.end()) {
      places_.push_back({blob.colour_class, p_T, blob.cells, 1});
    } else {
      same->seen = std::min(same->seen + 2, 40);
      same->cells = std::max(same->cells, blob.cells);
    }
  }
  std::erase_if(places_, [](const Place& p) { return p.seen <= 0; });
}

bool Distractors::Known(const Blob& blob, const Pose& X_TC) const {
  if (blob.readings == 0) return false;
  const Vector3 p_T = X_TC * blob.p_C;
  return std::any_of(places_.begin(), places_.end(), [&](const Place& p) {
    return p.seen >= 3 && p.colour_class == blob.colour_class && (p.p_T - p_T).norm() < 0.03 &&
           blob.cells < 1.5 * p.cells + 4;
  });
}

}  // namespace coach
