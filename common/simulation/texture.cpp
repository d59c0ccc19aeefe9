// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace rf::sim {
namespace {

std::array<float, 256> linearTable() {
  std::array<float, 256> table{};
  for (int i = 0; i < 256; ++i) {
    const double s = i / 255.0;
    const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
    table[static_cast<std::size_t>(i)] = static_cast<float>(linear);
  }
  return table;
}

const std::array<float, 256> kLinear = linearTable();

Image<Rgb> halved(const Image<Rgb>& in) {
  Image<Rgb> out(std::max(1, in.width() / 2), std::max(1, in.height() / 2));
  for (int v = 0; v < out.height(); ++v) {
    for (int u = 0; u < out.width(); ++u) {
      const int u1 = std::min(2 * u + 1, in.width() - 1);
      const int v1 = std::min(2 * v + 1, in.height() - 1);
      const std::array<Rgb, 4> c = {in(2 * u, 2 * v), in(u1, 2 * v), in(2 * u, v1), in(u1, v1)};
      const auto mean = [&](std::uint8_t Rgb::*m) {
        return static_cast<std::uint8_t>((c[0].*m + c[1].*m + c[2].*m + c[3].*m + 2) / 4);
      };
      out(u, v) = {mean(&Rgb::r), mean(&Rgb::g), mean(&Rgb::b)};
    }
  }
  return out;
}

int mirrored(int i, int n) {
  if (i >= 0 && i < n) return i;  // nearly always: spares the division
  const int period = 2 * n;
  i %= period;
  if (i < 0) i += period;
  return i < n ? i : period - 1 - i;
}

Eigen::Vector3f linear(const Rgb& c) { return {kLinear[c.r], kLinear[c.g], kLinear[c.b]}; }

Eigen::Vector3f bilinear(const Image<Rgb>& level, float u, float v) {
  const float fu = std::floor(u);
  const float fv = std::floor(v);
  const int u0 = mirrored(static_cast<int>(fu), level.width());
  const int u1 = mirrored(static_cast<int>(fu) + 1, level.width());
  const int v0 = mirrored(static_cast<int>(fv), level.height());
  const int v1 = mirrored(static_cast<int>(fv) + 1, level.height());
  const float a = u - fu;
  const float b = v - fv;
  return (1 - b) * ((1 - a) * linear(level(u0, v0)) + a * linear(level(u1, v0))) +
         b * ((1 - a) * linear(level(u0, v1)) + a * linear(level(u1, v1)));
}

}  // namespace

float linearFromSrgb(std::uint8_t value) { return kLinear[value]; }

Texture::Texture(Image<Rgb> picture) {
  if (picture.empty()) throw std::invalid_argument("Texture: empty picture");
  levels_.push_back(std::move(picture));
  while (levels_.back().width() > 1 || levels_.back().height() > 1) {
    levels_.push_back(halved(levels_.back()));
  }
}

Eigen::Vector3f Texture::sample(float u, float v, float footprint) const {
  const float level = std::max(0.0F, std::log2(std::max(footprint, 1e-6F)));
  const auto last = levels_.size() - 1;
  const std::size_t low = std::min(static_cast<std::size_t>(level), last);
  const auto at = [&](std::size_t i) {
    const float scale = 1.0F / static_cast<float>(1U << i);
    return bilinear(levels_[i], u * scale - 0.5F, v * scale - 0.5F);
  };
  const float share = low == last ? 0.0F : level - static_cast<float>(low);
  if (share < 0.05F) return at(low);
  return (1 - share) * at(low) + share * at(low + 1);
}

}  // namespace rf::sim
