// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/border_sides.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/pyramid.hpp"

namespace rf {

BorderSides borderSides(const Image<float>& depth, const Image<std::uint8_t>& label,
                        const std::vector<float>& gamma) {
  constexpr int kReach = 4;
  BorderSides out;
  const auto compare = [&](int u, int v, int du, int dv) {
    const bool body = gamma[label(u, v)] < 0.5F;
    for (int r = 1; r <= kReach && label.inside(u + r * du, v + r * dv); ++r) {
      const std::uint8_t other = label(u + r * du, v + r * dv);
      if (other >= gamma.size()) continue;
      const float step = depth(u + r * du, v + r * dv) - depth(u, v);
      if (body != (gamma[other] < 0.5F) && std::abs(step) >= kDefaultDepthGate) {
        ++((step > 0) == body ? out.body_nearer : out.body_farther);
      }
      return;
    }
  };
  for (int v = 0; v < label.height(); ++v) {
    for (int u = 0; u < label.width(); ++u) {
      if (label(u, v) >= gamma.size()) continue;
      compare(u, v, 1, 0);
      compare(u, v, 0, 1);
    }
  }
  return out;
}

double bodyBehind(const BorderSides& sides) {
  constexpr double kSeenBefore = 10.0;  // pixels of an image of 80x60
  return std::max(0.0,
                  std::log((sides.body_farther + kSeenBefore) / (sides.body_nearer + kSeenBefore)));
}

}  // namespace rf
