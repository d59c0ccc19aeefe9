// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensor_noise.hpp"

#include <algorithm>
#include <vector>

#include "geometry/parallel.hpp"
#include "simulation/random.hpp"

namespace rf::sim {
namespace {

constexpr int kRowsPerChunk = 32;  // of the running sums

void whiteNoise(std::vector<float>& out, std::uint64_t key) {
  for (std::size_t u = 0; u < out.size(); ++u) out[u] = normalFromBits(scramble(key + u));
}

/// White noise summed over 2 radius + 1 columns, for rows `first`..`last` of the padded image.
void rowSums(Image<float>& out, int first, int last, int radius, std::uint64_t key) {
  const int padded = out.width() + 2 * radius;
  std::vector<float> white(static_cast<std::size_t>(padded));
  for (int v = first; v < last; ++v) {
    whiteNoise(white, scramble(key, static_cast<std::uint64_t>(v)));
    float* target = out.row(v);
    for (int k = 0; k <= 2 * radius; ++k) {
      const float* source = white.data() + k;
      for (int u = 0; u < out.width(); ++u) target[u] += source[u];
    }
  }
}

}  // namespace

Image<float> correlatedNoise(int width, int height, int radius, std::uint64_t key) {
  const int padded = height + 2 * radius;
  Image<float> sums(width, padded);
  parallelChunks((padded + kRowsPerChunk - 1) / kRowsPerChunk, [&](int chunk) {
    const int first = chunk * kRowsPerChunk;
    rowSums(sums, first, std::min(first + kRowsPerChunk, padded), radius, key);
  });
  if (radius == 0) return sums;
  const float scale = 1.0F / static_cast<float>(2 * radius + 1);
  Image<float> out(width, height);
  parallelRows(height, [&](int v) {
    float* target = out.row(v);
    for (int k = 0; k <= 2 * radius; ++k) {
      const float* source = sums.row(v + k);
      for (int u = 0; u < width; ++u) target[u] += source[u];
    }
    for (int u = 0; u < width; ++u) target[u] *= scale;
  });
  return out;
}

}  // namespace rf::sim
