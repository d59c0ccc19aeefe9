// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "simulation/raycaster.hpp"

namespace rf::sim {

/// How far every surface point moves in the image while the shutter is open, pixels; from the poses
/// at the shutter's opening and closing, symmetric about the frame's time.
Image<Eigen::Vector2f> shutterFlow(const World& world, const SurfaceImage& surface,
                                   std::span<const SE3> T_CB, std::span<const SE3> T_CB_open,
                                   std::span<const SE3> T_CB_close);

/// Motion blur: the mean of the light along each pixel's flow.
Image<Eigen::Vector3f> blurred(const Image<Eigen::Vector3f>& light,
                               const Image<Eigen::Vector2f>& flow);

/// What a camera of the kind has of its own and what changes from frame to frame.
struct ColourResponse {
  float gain = 1;                                     ///< exposure
  Eigen::Vector3f balance = Eigen::Vector3f::Ones();  ///< white balance
  float vignette = 0.2F;                              ///< loss of light in the corners
  float noise = 2.2F;                                 ///< of 255, in the middle tones
};

/// Response at frame k of a sequence: slow wobble of exposure and white balance about values that
/// depend on the seed, and an automatic exposure that half follows the scene's brightness.
ColourResponse responseAt(int frame, std::uint64_t seed, const Image<Eigen::Vector3f>& light);

/// Linear light to a picture: softness of the lens and the colour mosaic, vignette, exposure, tone
/// curve, grain in brightness and blotches in colour. The key decides the noise.
Image<Rgb> develop(const Image<Eigen::Vector3f>& light, const ColourResponse& response,
                   std::uint64_t key);

/// Seconds that the shutter is open.
inline constexpr double kShutter = 1.0 / 60.0;

}  // namespace rf::sim
