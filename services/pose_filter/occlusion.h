// The chance that something is in front of a part at a pixel: a two-state Markov chain.
// [Wuethrich et al., "Probabilistic Object Tracking using a Range Camera", IROS 2013]
#pragma once

namespace coach {

/// Chances after one second.
struct OcclusionChain {
  double becomes_occluded = 0.1;  ///< a: of a visible pixel to be occluded
  double stays_occluded = 0.7;    ///< b: of an occluded pixel to be so still; over a
  double initial = 0.1;
};

/// o' = scale * o + offset: the chance of occlusion after `dt` seconds, with c = b - a: c^dt o + (1 - c^dt) a / (1 -
/// c).
struct OcclusionStep {
  float scale = 1, offset = 0;
  float operator()(float o) const { return scale * o + offset; }
};
OcclusionStep PredictOcclusion(const OcclusionChain& chain, double dt);

}  // namespace coach
