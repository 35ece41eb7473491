// The one source of chance: small, fast, and the same on every machine.
#pragma once

#include <cstdint>

namespace coach {

/// xoshiro256++ 1.0 [Blackman and Vigna 2019], seeded by splitmix64.
class Random {
 public:
  explicit Random(uint64_t seed);

  uint64_t Bits();
  double Uniform();  ///< in [0, 1)
  double Normal();   ///< mean 0, variance 1
  int Below(int n);  ///< in [0, n), n positive

 private:
  uint64_t state_[4];
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace coach
