// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "simulation/lighting.hpp"
#include "simulation/raycaster.hpp"

namespace rf::sim {

/// Per pixel: the light that reaches the camera and what the depth sensor needs to know.
struct Shaded {
  Image<Eigen::Vector3f> light;  ///< linear, 1 = a white surface in good light
  Image<float> cosine;           ///< between the ray and the surface's normal, 0..1
  Image<float> infrared;         ///< reflectivity, 0..1
  Image<std::uint8_t> body;      ///< 0 the static world
};

/// Lights the surfaces that the rays met: textures filtered to the pixel's footprint, baked light
/// with the moving bodies' soft shadows, mirror images of the lamps on glossy surfaces, and pixels
/// on borders averaged over four rays. T_WB, T_WC as given to the raycaster.
Shaded shade(const World& world, const LampLight& lamps, const BakedLight& baked,
             const Raycaster& caster, const SurfaceImage& surface, std::span<const SE3> T_WB,
             const SE3& T_WC);

}  // namespace rf::sim
