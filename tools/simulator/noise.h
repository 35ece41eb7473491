// Fast image noise: a table of normal numbers read from random places.
#pragma once

#include <algorithm>
#include <vector>

#include "tools/simulator/random.h"

namespace coach {

class NoiseTable {
 public:
  static constexpr size_t kSize = 1 << 16;

  explicit NoiseTable(Random& random) : values_(kSize) {
    for (float& v : values_) v = static_cast<float>(random.Normal());
  }
  /// `start` any number, `i` steps from it.
  float At(size_t start, size_t i) const { return values_[(start + i) & (kSize - 1)]; }

 private:
  std::vector<float> values_;
};

/// A field of normal numbers of standard deviation 1 whose neighbours agree over about `cell` pixels.
class SmoothNoise {
 public:
  SmoothNoise(int width, int height, int cell) : cell_(cell), nx_(width / cell + 3), ny_(height / cell + 3) {
    nodes_.resize(static_cast<size_t>(nx_ * ny_));
  }
  void Draw(Random& random, const NoiseTable& table) {
    const size_t start = random.Bits();
    for (size_t i = 0; i < nodes_.size(); ++i) nodes_[i] = table.At(start, i);
  }
  /// The values of row y, `width` of them. Bilinear; scaled by 1.5 so that the average variance between the nodes is 1.
  void Row(int y, int width, float* out) const {
    const float step = 1 / static_cast<float>(cell_);
    const float fy = static_cast<float>(y % cell_) * step;
    const float* n = &nodes_[static_cast<size_t>(y / cell_ * nx_)];
    for (int x0 = 0; x0 < width; x0 += cell_, ++n) {
      const float left = 1.5f * ((1 - fy) * n[0] + fy * n[nx_]), right = 1.5f * ((1 - fy) * n[1] + fy * n[nx_ + 1]);
      const float slope = step * (right - left);
      for (int x = x0; x < std::min(x0 + cell_, width); ++x) out[x] = left + static_cast<float>(x - x0) * slope;
    }
  }

 private:
  int cell_, nx_, ny_;
  std::vector<float> nodes_;
};

}  // namespace coach
