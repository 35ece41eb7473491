// Weights of a set of particles: degeneration and resampling.
#pragma once

#include <vector>

#include "services/pose_filter/random.h"

namespace coach {

/// Turns log weights into weights of sum 1. Values of minus infinity get 0. If none is finite, all get the same.
void NormaliseWeights(const std::vector<double>& log_weights, std::vector<double>& weights);

/// Kullback-Leibler divergence (nats) of normalised weights from uniform ones: log n + sum w log w. 0: all the same;
/// log n: one has it all.
double DivergenceFromUniform(const std::vector<double>& weights);

/// Systematic resampling: for each new particle the index of its parent, in growing order; one random number for all.
/// Particle i gets floor or ceiling of n * weight copies.
void SystematicResample(const std::vector<double>& weights, Random& random, std::vector<int>& parents);

}  // namespace coach
