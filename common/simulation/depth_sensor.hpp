// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"

namespace rf::sim {

/// Stored depth units per metre, as in the TUM benchmark.
inline constexpr double kDepthFactor = 5000.0;

/// What the infrared camera looks at, per pixel.
struct DepthInput {
  Image<float> z;              ///< true metres along the optical axis, 0 = nothing
  Image<float> cosine;         ///< between the ray and the surface's normal, 0..1
  Image<float> infrared;       ///< reflectivity, 0..1
  Image<std::uint8_t> body;    ///< 0 the static world, 1.. moving bodies
  int first_robot_body = 256;  ///< bodies from here on are links of the robot
};

struct DepthOutput {
  Image<std::uint16_t> depth;  ///< kDepthFactor units per metre, 0 = no measurement
  Image<std::uint8_t> mask;    ///< 0 no depth, 1 static world, 2 moving body, 3 robot
};

/// Structured-light depth sensor of the Asus Xtion kind; constants and their sources stand in
/// docs/SIMULATION.md. Structure: standard deviation depthSigma(z), alike over a few pixels;
/// disparity in steps of 1/8 px; depth edges ragged by about a pixel and a half; holes where little
/// of the pattern comes back (dark, slanted, far) or the projector, 7.5 cm beside the camera, is
/// hidden; range 0.4 to 5 m; an empty border that comes from registering depth to colour. The mask
/// tells of which body the measured surface is. The key decides the noise; the same for any thread
/// count. `noise` scales the standard deviation that is not of the disparity steps.
DepthOutput senseDepth(const DepthInput& input, const Camera& camera, std::uint64_t key,
                       float noise = 1.0F);

/// Standard deviation of a measurement at z metres, quantisation included.
double depthSigma(double z);

/// Baseline times focal length: disparity in pixels is this over z.
inline constexpr double kBaseline = 0.075;       // metres
inline constexpr double kInfraredFocal = 570.0;  // pixels at 640 x 480
inline constexpr double kDisparityStep = 0.125;  // pixels

}  // namespace rf::sim
