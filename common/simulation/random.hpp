// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace rf::sim {

/// Scrambles 64 bits (the finaliser of SplitMix64): neighbouring inputs give unrelated outputs.
constexpr std::uint64_t scramble(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31);
}

constexpr std::uint64_t scramble(std::uint64_t a, std::uint64_t b) {
  return scramble(scramble(a) ^ (b * 0xD6E8FEB86659FD93ULL));
}

/// A small generator whose numbers are the same on every standard library. Copies are independent.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(scramble(seed)) {}
  Random(std::uint64_t seed, std::uint64_t purpose) : state_(scramble(seed, purpose)) {}

  std::uint64_t bits() { return scramble(++state_); }
  /// In (0, 1).
  double uniform() { return (static_cast<double>(bits() >> 11) + 0.5) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// In 0..n-1, n > 0.
  int below(int n) { return static_cast<int>(uniform() * n); }
  bool chance(double p) { return uniform() < p; }
  double normal() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }

 private:
  std::uint64_t state_;
};

/// About normal, zero mean, unit variance, from 64 scrambled bits: the sum of four 16-bit uniforms
/// (tails end at 3.5 sigma, as a sensor's clipped noise does). Far cheaper than a logarithm.
inline float normalFromBits(std::uint64_t bits) {
  const std::uint64_t sum =
      (bits & 0xFFFF) + ((bits >> 16) & 0xFFFF) + ((bits >> 32) & 0xFFFF) + (bits >> 48);
  // By way of 32 bits: that conversion has a vector instruction.
  return (static_cast<float>(static_cast<std::int32_t>(sum)) - 131070.0F) * (1.0F / 37837.0F);
}

/// In [0, 1), from the upper bits.
inline float unitFromBits(std::uint64_t bits) { return static_cast<float>(bits >> 40) * 0x1p-24F; }

}  // namespace rf::sim
