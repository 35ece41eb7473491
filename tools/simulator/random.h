// Seeded random numbers for the simulated classroom.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace coach {

/// The same numbers for the same seed on every machine: built on the bits of mt19937_64 only.
class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed * 0x9E3779B97F4A7C15ull + 0x632BE59BD9B4E019ull) {}

  double Uniform(double low, double high) { return low + (high - low) * Unit(); }
  /// Standard normal.
  double Normal() { return std::sqrt(-2 * std::log(1 - Unit())) * std::cos(2 * std::numbers::pi * Unit()); }
  /// 0 .. n-1; n >= 1.
  int Pick(int n) { return static_cast<int>(engine_() % static_cast<uint64_t>(n)); }
  bool Chance(double p) { return Unit() < p; }
  uint64_t Bits() { return engine_(); }

 private:
  double Unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  std::mt19937_64 engine_;
};

}  // namespace coach
