// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/simulator.hpp"

namespace rf::sim {

/// A point on a true surface, in its body's frame.
struct SurfacePoint {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;  ///< unit, outward
};

/// Dense points on the true surfaces and which of them the sensor got to see: what a model of the
/// sequence can be measured against. Not thread-safe.
class SurfaceSamples {
 public:
  /// Points of each body lie about `spacing` metres apart (static world, moving bodies).
  SurfaceSamples(const World& world, double static_spacing, double body_spacing);

  /// Counts the points that this frame's depth image shows.
  void see(const SimulatedFrame& frame);

  /// Points of a body that at least `frames` frames showed.
  std::vector<SurfacePoint> seen(int body, int frames) const;

 private:
  struct Body {
    std::vector<SurfacePoint> points;
    std::vector<std::uint16_t> count;
  };
  Camera camera_;
  std::vector<Body> bodies_;
};

}  // namespace rf::sim
