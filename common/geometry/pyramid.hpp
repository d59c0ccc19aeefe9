// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"

namespace rf {

/// One level of an RGB-D pyramid, free of lens distortion. Both planes have the camera's size.
struct RgbdLevel {
  Camera camera;           ///< without distortion
  Image<float> intensity;  ///< 0..1, luma 0.299 R + 0.587 G + 0.114 B
  Image<float> depth;      ///< metres, 0 = invalid
};

/// Depth step in metres that separates surfaces in the reduction (tau of algorithm A.1).
inline constexpr float kDefaultDepthGate = 0.1F;

/// Makes the working level from an undistorted frame: luma, metres, then a depth-aware reduction by
/// `reduction` in both directions. Depth outside [min_depth_m, max_depth_m] becomes 0.
/// Factor 1 converts only. Powers of two apply reduceByTwo repeatedly. Other factors average a
/// block: the median of its measured depths is the centre depth, the same gate weighs depth and
/// intensity; a block with measurements in less than a quarter of its pixels has no depth. Throws
/// std::invalid_argument when sizes differ from the camera's, the camera has distortion, reduction
/// < 1 or the result would be empty.
RgbdLevel reduceFrame(const Image<Rgb>& colour, const Image<std::uint16_t>& depth_mm,
                      const Camera& undistorted_camera, int reduction, double min_depth_m,
                      double max_depth_m);

/// Next coarser level. Pixel (u, v) takes the 4x4 block around the 2x2 centre (2u, 2v), (2u+1,
/// 2v+1) with binomial weights (1,2,2,1)^2 / 36; d_c = second largest of the four central depths
/// (no depth when three of them are invalid); weights are multiplied by max(0, gate - |d - d_c|)
/// for intensity AND depth, so nothing bleeds over depth edges. At the border plain means of the
/// 2x2 centre.
RgbdLevel reduceByTwo(const RgbdLevel& finer, float depth_gate_m = kDefaultDepthGate);

/// [0] is `finest`; stops early when a level would be smaller than 8 pixels in either direction.
/// Throws std::invalid_argument when levels < 1.
std::vector<RgbdLevel> buildPyramid(RgbdLevel finest, int levels,
                                    float depth_gate_m = kDefaultDepthGate);

}  // namespace rf
