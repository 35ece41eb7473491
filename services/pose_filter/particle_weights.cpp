#include "services/pose_filter/particle_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace coach {

void NormaliseWeights(const std::vector<double>& log_weights, std::vector<double>& weights) {
  double highest = -std::numeric_limits<double>::infinity();
  for (const double w : log_weights) {
    if (w > highest) highest = w;
  }
  weights.assign(log_weights.size(), 1.0 / static_cast<double>(log_weights.size()));
  if (!std::isfinite(highest)) return;
  double sum = 0;
  for (size_t i = 0; i < log_weights.size(); ++i) {
    weights[i] = std::isnan(log_weights[i]) ? 0 : std::exp(log_weights[i] - highest);
    sum += weights[i];
  }
  for (double& w : weights) w /= sum;
}

double DivergenceFromUniform(const std::vector<double>& weights) {
  double divergence = std::log(static_cast<double>(weights.size()));
  for (const double w : weights) {
    if (w > 0) divergence += w * std::log(w);
  }
  return std::max(0.0, divergence);
}

void SystematicResample(const std::vector<double>& weights, Random& random, std::vector<int>& parents) {
  const size_t n = weights.size();
  parents.resize(n);
  double cumulative = weights[0];
  size_t parent = 0;
  const double start = random.Uniform();
  for (size_t i = 0; i < n; ++i) {
    const double at = (static_cast<double>(i) + start) / static_cast<double>(n);
    while (cumulative < at && parent + 1 < n) cumulative += weights[++parent];
    parents[i] = static_cast<int>(parent);
  }
}

}  // namespace coach
