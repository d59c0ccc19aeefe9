// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulation/depth_sensor.hpp"
#include "simulation/lighting.hpp"
#include "simulation/raycaster.hpp"
#include "simulation/world.hpp"

namespace rf::sim {

/// One frame of a sequence with its truth.
struct SimulatedFrame {
  std::int64_t utime = 0;  ///< microseconds; colour and depth are taken together
  Image<Rgb> colour;
  Image<std::uint16_t> depth;  ///< kDepthFactor units per metre, 0 = no measurement
  Image<std::uint8_t> mask;    ///< 0 no depth, 1 static, 2 moving body (also at rest), 3 robot
  SE3 T_WC;
  std::vector<SE3> T_WB;        ///< of every body, the static world's identity first
  Image<float> true_z;          ///< metres, without noise
  double object_speed_mps = 0;  ///< of body 1's origin
};

/// Renders a scene frame by frame. Frame k is a function of (scene, seed, k) alone. Thread-safe.
class Simulator {
 public:
  /// `noise` scales the noise of depth (beside its disparity steps) and of the picture. Throws
  /// std::invalid_argument for an unknown scene and a factor that is negative or not finite.
  Simulator(const std::string& scene, std::uint64_t seed, double noise = 1.0);

  const World& world() const { return world_; }
  int frames() const { return world_.frames; }
  SimulatedFrame frame(int k) const;
  /// Capture time of frame k: kStartUtime at frame 0, then 1/30 s apart.
  static std::int64_t utime(int k);

 private:
  std::uint64_t seed_;
  float noise_;
  World world_;
  LampLight lamps_;
  BakedLight baked_;
};

inline constexpr std::int64_t kStartUtime = 1'000'000'000;

}  // namespace rf::sim
