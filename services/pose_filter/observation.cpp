#include "services/pose_filter/observation.h"

#include <cstdlib>

namespace coach {

float Observation::LikelyDepth(int x, int y) const {
  constexpr int kReach = 24;        // px; the shadow of an arm 20 cm above the table at 1 m is half as wide
  constexpr int kResemblance = 90;  // sum of absolute differences, of 765
  if (!bgr || !depth) return 0;
  const size_t row = static_cast<size_t>(y) * static_cast<size_t>(camera.width);
  const uint8_t* own = bgr + 3 * (row + static_cast<size_t>(x));
  float likely = 0;
  int least = kResemblance;
  for (const int way : {-1, 1}) {
    for (int i = x + way; i >= 0 && i < camera.width && std::abs(i - x) <= kReach; i += way) {
      if (depth[row + static_cast<size_t>(i)] == 0) continue;
      const uint8_t* p = bgr + 3 * (row + static_cast<size_t>(i));
      const int difference = std::abs(p[0] - own[0]) + std::abs(p[1] - own[1]) + std::abs(p[2] - own[2]);
      if (difference < least) {
        least = difference;
        likely = Depth(i, y);
      }
      break;
    }
  }
  return likely;
}

}  // namespace coach
