#include "services/pose_filter/process_model.h"

#include <algorithm>
#include <cmath>

namespace coach {

void Propagate(const ProcessOptions& options, double dt, Random& random, MotionState& state) {
  constexpr double kStepsPerSecond = 30;
  constexpr double kRounding = 1e-3;  // time stamps are whole microseconds: no extra step for a rest of one
  double left = kStepsPerSecond * std::clamp(dt, 0.0, options.longest_gap);
  while (left > kRounding) {
    const double rho = left < 1 + kRounding ? std::min(left, 1.0) : 1;
    left -= 1;
    const double damping = std::pow(options.damping, rho), scale = std::sqrt(rho);
    for (int i = 0; i < 6; ++i) {
      const double noise = scale * (i < 3 ? options.position_noise : options.rotation_noise) * random.Normal();
      const double carried = damping * state.v[i];
      state.q[i] += rho * carried + noise;
      state.v[i] = carried + noise;
    }
  }
}

}  // namespace coach
