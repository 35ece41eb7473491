#include "common/assembly/connection_probability.h"

#include <algorithm>
#include <numbers>

namespace coach {

double DistanceProbability(const Vector3& x, const Vector3& y, const ConnectionProbabilityOptions& options) {
  return std::clamp(((x - y).norm() - options.beta) / (options.alpha - options.beta), 0.0, 1.0);
}

double PaperConnectionProbability(const Pose& X_AB_desired, const Pose& X_AB,
                                  const ConnectionProbabilityOptions& options) {
  return 0.5 * DistanceProbability(X_AB_desired.translation(), X_AB.translation(), options) +
         0.5 * DistanceProbability(X_AB_desired.inverse().translation(), X_AB.inverse().translation(), options);
}

double PaperConnectionProbability(const SymmetryGroup& a, const SymmetryGroup& b, const Pose& X_AB_desired,
                                  const Pose& X_AB, const ConnectionProbabilityOptions& options) {
  constexpr double kAxisStep = std::numbers::pi / 12;
  double best = 0;
  for (const Matrix3& S_A : SampledElements(a, kAxisStep)) {
    for (const Matrix3& S_B : SampledElements(b, kAxisStep)) {
      Pose X = X_AB_desired;
      X.linear() = S_A * X_AB_desired.linear() * S_B;
      X.translation() = S_A * X_AB_desired.translation();
      best = std::max(best, PaperConnectionProbability(X, X_AB, options));
      if (best >= 1) return best;
    }
  }
  return best;
}

}  // namespace coach
