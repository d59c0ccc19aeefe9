// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "simulation/random.hpp"

namespace rf::sim {

/// Value noise: random values in [0, 1) at integer points, blended smoothly between them.
inline float valueNoise(std::uint64_t seed, double x, double y) {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx);
  const auto iy = static_cast<std::int64_t>(fy);
  const auto value = [&](std::int64_t i, std::int64_t j) {
    return unitFromBits(scramble(seed ^ (static_cast<std::uint64_t>(i) * 0x8DA6B343ULL) ^
                                 (static_cast<std::uint64_t>(j) * 0xD8163841ULL << 20U)));
  };
  const auto smooth = [](double s) { return static_cast<float>(s * s * (3 - 2 * s)); };
  const float a = smooth(x - fx);
  const float b = smooth(y - fy);
  const float low = value(ix, iy) * (1 - a) + value(ix + 1, iy) * a;
  const float high = value(ix, iy + 1) * (1 - a) + value(ix + 1, iy + 1) * a;
  return low * (1 - b) + high * b;
}

/// Sum of value noises of doubling frequency and halving strength, scaled to about 0..1.
class Fractal {
 public:
  explicit Fractal(std::uint64_t seed) : seed_(seed) {}
  double at(double x, double y, int octaves) const {
    double sum = 0;
    double weight = 0;
    double strength = 1;
    for (int i = 0; i < octaves; ++i, strength *= 0.5) {
      sum += strength * valueNoise(seed_ + static_cast<std::uint64_t>(i), x, y);
      weight += strength;
      x *= 2.03;
      y *= 2.03;
    }
    return sum / weight;
  }

 private:
  std::uint64_t seed_;
};

}  // namespace rf::sim
