#include "services/pose_filter/occlusion.h"

#include <cmath>

namespace coach {

OcclusionStep PredictOcclusion(const OcclusionChain& chain, double dt) {
  const double c = chain.stays_occluded - chain.becomes_occluded;
  const double scale = std::pow(c, dt);
  return {static_cast<float>(scale), static_cast<float>((1 - scale) * chain.becomes_occluded / (1 - c))};
}

}  // namespace coach
