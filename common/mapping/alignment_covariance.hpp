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

/// Covariance (right perturbation) of the pose that minimises sum w r^2 / correlation plus a prior
/// with that information: I^-1 (S + I) I^-1, where I = H + prior is the information that the
/// sensor's model promises for independent pixels and S what is wrong together all over a block:
/// - the gradient that is left in each block, n/(n-6) g g' (sandwich estimator, clustered by
/// blocks:
///   White 1980, Liang and Zeger 1986): residuals that the noise model does not explain,
/// - a common displacement of the block, H_b C_b H_b, that leaves no residual: C_b has the
///   sampling phase of a pixel across and a share of the depth noise along the axis, see
///   CommonError.
Mat6 alignmentCovariance(const std::vector<AlignmentBlock>& blocks, const Mat6& prior,
                         double correlation, double focal_px, const SensorModel& sensor);

/// What all pixels of a block have in common.
struct CommonError {
  /// Across, pixels: surfels and image sample the surface in steps of a pixel; a place within a
  /// step is uniform, 1/sqrt(12).
  static constexpr double kPhase = 0.29;
  /// Along the axis, of the sensor's sigma: noise that is alike over 13 px of the input leaves 0.1
  /// of it in the mean of a block of 80, disparity steps add to that. Of 0, 0.2, 0.35 and 0.5 the
  /// one with which translations and rotations are equally honest (docs/HEALTH.md).
  static constexpr double kDepthShare = 0.2;
};

}  // namespace rf
