#include "tools/simulator/surface.h"

#include <algorithm>

namespace coach {
namespace {

constexpr int kSize = Pattern::kSize;

/// Tileable value noise with `cells` cells a side, bilinear with smooth weights.
class ValueNoise {
 public:
  ValueNoise(int cells_x, int cells_y, Random& random) : nx_(cells_x), ny_(cells_y) {
    for (int i = 0; i < nx_ * ny_; ++i) grid_.push_back(random.Uniform(0, 1));
  }

  double At(double u, double v) const {
    const double x = u * nx_, y = v * ny_;
    const double fx = Smooth(x - std::floor(x)), fy = Smooth(y - std::floor(y));
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    return (1 - fy) * ((1 - fx) * Node(x0, y0) + fx * Node(x0 + 1, y0)) +
           fy * ((1 - fx) * Node(x0, y0 + 1) + fx * Node(x0 + 1, y0 + 1));
  }

 private:
  static double Smooth(double t) { return t * t * (3 - 2 * t); }
  double Node(int x, int y) const {
    return grid_[static_cast<size_t>(((y % ny_ + ny_) % ny_) * nx_ + (x % nx_ + nx_) % nx_)];
  }
  int nx_, ny_;
  std::vector<double> grid_;
};

double Value(Pattern::Kind kind, double u, double v, const ValueNoise& coarse, const ValueNoise& middle,
             const ValueNoise& fine, const ValueNoise& grain) {
  switch (kind) {
    case Pattern::Kind::kPlain:
      return 0.2 * coarse.At(u, v);
    case Pattern::Kind::kCloth:
      return 0.35 * fine.At(u, v) + 0.35 * middle.At(u, v) + 0.3 * coarse.At(u, v);
    case Pattern::Kind::kWood: {
      const double plank = std::floor(v * 4) * 0.37;
      const double seam = std::abs(v * 4 - std::round(v * 4)) < 0.012 ? 0.45 : 0;
      const double rings = 0.5 + 0.5 * std::sin(2 * std::numbers::pi * (3 * coarse.At(u + plank, v) + 6 * v));
      return 0.35 * rings + 0.4 * grain.At(u + plank, v) + 0.15 * middle.At(u, v) + seam;
    }
    case Pattern::Kind::kPatches:
      return (coarse.At(u, v) > 0.5 ? 0.85 : 0) + 0.15 * fine.At(u, v);
    case Pattern::Kind::kSpeckle:
      return std::pow(fine.At(u, v), 4) + 0.1 * middle.At(u, v);
  }
  return 0;
}

}  // namespace

Pattern::Pattern(Kind kind, Random& random) : values_(static_cast<size_t>(kSize * kSize)) {
  const ValueNoise coarse(5, 5, random), middle(19, 19, random), fine(96, 96, random), grain(4, 120, random);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double value = Value(kind, (x + 0.5) / kSize, (y + 0.5) / kSize, coarse, middle, fine, grain);
      values_[static_cast<size_t>(y * kSize + x)] = static_cast<float>(std::clamp(value, 0.0, 1.0));
    }
  }
}

Vector3 FromSrgb(int r, int g, int b) {
  const auto linear = [](int c) {
    const double s = c / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  return {linear(r), linear(g), linear(b)};
}

}  // namespace coach
