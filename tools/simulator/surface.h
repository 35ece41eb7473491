// What surfaces look like, to the eye and to the depth sensor.
#pragma once

#include <array>
#include <vector>

#include "common/geometry/pose.h"
#include "tools/simulator/random.h"

namespace coach {

/// A tileable grey pattern with values in [0, 1].
class Pattern {
 public:
  enum class Kind { kPlain, kCloth, kWood, kPatches, kSpeckle };
  static constexpr int kSize = 256;

  Pattern(Kind kind, Random& random);

  /// Value at (u, v) in tiles, each within +-250; wraps.
  float At(float u, float v) const {
    // Truncation is the floor of a number that was made positive by whole tiles.
    constexpr float kWhole = 256 * kSize;
    const int x = static_cast<int>(u * kSize + kWhole) & (kSize - 1);
    const int y = static_cast<int>(v * kSize + kWhole) & (kSize - 1);
    return values_[static_cast<size_t>(y * kSize + x)];
  }

 private:
  std::vector<float> values_;
};

struct Material {
  Vector3 colour{0.5, 0.5, 0.5};         ///< linear albedo where the pattern is 0
  Vector3 second_colour{0.5, 0.5, 0.5};  ///< and where it is 1
  int pattern = 0;                       ///< index into the room's patterns
  double tile = 0.3;                     ///< m a tile of the pattern
  double gloss = 0.1;                    ///< strength of the highlight, 0..1
  double depth_holes = 0;                ///< 0..1: share of its area on which the depth sensor reads nothing
};

/// Linear albedo from an sRGB triple of 0..255.
Vector3 FromSrgb(int r, int g, int b);

}  // namespace coach
