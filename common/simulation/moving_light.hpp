// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "simulation/lighting.hpp"
#include "simulation/raycaster.hpp"

namespace rf::sim {

/// The lamps' light as far as it depends on where the moving bodies are, on every fourth pixel: on
/// the static world the share of the baked light that the bodies let through (their soft shadows),
/// on the bodies themselves the light. Const members are thread-safe.
class MovingLight {
 public:
  MovingLight(const World& world, const LampLight& lamps, const Raycaster& caster,
              const SurfaceImage& surface, std::span<const SE3> T_WB, const SE3& T_WC);

  /// At a pixel, from the grid points around it that lie on the same surface.
  Eigen::Vector3f at(int u, int v) const;

 private:
  void findOpen();
  struct Sample {
    Eigen::Vector3f value = Eigen::Vector3f::Ones();
    float z = 0;
    std::int16_t primitive = -1;
    std::uint8_t face = 0;
    bool moving = false;
  };
  const SurfaceImage& surface_;
  const World& world_;
  Image<Sample> grid_;
  Image<std::uint8_t> open_;  ///< 1 where no static one of the samples at +0 and +1 is hidden
};

}  // namespace rf::sim
