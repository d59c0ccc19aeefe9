// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "geometry/camera.hpp"
#include "geometry/se3.hpp"
#include "mapping/sensor_model.hpp"
#include "mapping/tracker_kernel.hpp"

namespace rf {

/// The 6x6 matrix of which a sum keeps the upper triangle.
Mat6 hessianOf(const KernelSums& sums);

/// The rows of one block of the image: their sums at the aligned pose, and the block's mean depth.
struct AlignmentBlock {
  KernelSums sums;
  double depth = 0;  ///< metres
};

/// Sums over the blocks of a fixed grid on the reference's image, at the pose, scales and
/// brightness of `input`; blocks without a pair are left out.
std::vector<AlignmentBlock> alignmentBlocks(const ReferencePoints& points, const Camera& camera,
                                            const KernelInput& input);

/// What the rows of an alignment are weighted by, and how well that fits.
struct AlignmentNoise {
  Mat6 prior = Mat6::Zero();  ///< information of the start
  double correlation = 1;     ///< pixels for one independent measurement
  double focal_px = 1;
  SensorModel sensor;
  double factor = 1;   ///< whitened rms of the residuals: what is measured of what is assumed
  double assumed = 1;  ///< SensorConfig::noise, contained in `sensor` and in the rows' weights
};

/// Covariance (right perturbation) of the pose that minimises sum w r^2 / correlation plus the
/// prior: I^-1 (S + W) I^-1, where I = H + prior is the information, W what it would be wrong by
/// for independent pixels, and S what is wrong together:
/// - the gradient that is left in each block, n/(n-6) g g' (sandwich estimator, clustered by
/// blocks:
///   White 1980, Liang and Zeger 1986): residuals that the noise model does not explain,
/// - displacements of each block of its own and of all blocks alike, H_b c_b, that leave no
///   residual, see CommonError.
Mat6 alignmentCovariance(const std::vector<AlignmentBlock>& blocks, const AlignmentNoise& noise);

/// What pixels have in common, at residuals as large as the sensor's model says (times
/// AlignmentNoise::factor).
struct CommonError {
  /// Of a block, across, pixels: surfels and image sample the surface in steps of a pixel; a place
  /// within a step is uniform, 1/sqrt(12).
  static constexpr double kPhase = 0.29;
  /// Of a block, along the axis, of the sensor's sigma: noise that is alike over 13 px of the input
  /// leaves 0.1 of it in the mean of a block of 80, disparity steps add to that. Of 0, 0.2, 0.35
  /// and 0.5 the one with which translations and rotations are equally honest (docs/HEALTH.md).
  static constexpr double kDepthShare = 0.2;
  /// Of all blocks, along the axis, of each one's sigma: of several surfels that cover a pixel the
  /// nearest is drawn, so a young map lies before the surface (docs/HEALTH.md).
  static constexpr double kNearerShare = 0.1;
};

}  // namespace rf
