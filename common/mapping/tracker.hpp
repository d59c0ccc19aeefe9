// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "geometry/se3.hpp"
#include "mapping/fusion_config.hpp"
#include "mapping/prediction.hpp"
#include "mapping/tracker_kernel.hpp"

namespace rf {

/// One pyramid level of the current frame.
struct TrackLevel {
  Camera camera;
  Image<float> depth;      ///< metres, 0 = none
  Image<float> intensity;  ///< 0..1
};

/// One body's share of the pixels at each level (0..1), finest first.
using WeightPyramid = std::vector<Image<float>>;

/// Means over 2x2; `levels` images, finest first.
WeightPyramid weightPyramid(Image<float> finest, int levels);

/// One level of the model as seen from the frame P of the prediction.
struct TrackReference {
  Camera camera;
  ReferencePoints points;
};

/// The prediction as point sets of `levels` levels, finest first. Surfels of at least `full_logit`
/// count in full, others by the ratio of their confidence to it. Depth and intensity of coarser
/// levels are made like those of frames.
std::vector<TrackReference> makeReference(const Prediction& prediction, int levels,
                                          float full_logit);

/// Front-most of two predictions from the same pose, pixel by pixel (ids are those of either).
Prediction mergeNearest(const Prediction& a, const Prediction& b);

struct TrackResult {
  SE3 T_PC;                            ///< current camera in the prediction's camera frame
  Mat6 covariance = Mat6::Identity();  ///< right perturbation, translation first, given the model:
                                       ///< see alignment_covariance.hpp
  double inliers = 0;                  ///< weighted count, finest level
  double pairs = 0;  ///< weighted count of points of the model with a measurement not before them
  double inlier_share = 0;   ///< of the pairs in view
  double visible_share = 0;  ///< of the model's pixels in view, not hidden by something nearer
  double rms_sigma = 0;      ///< whitened depth residual of the inliers
  double rms_m = 0;          ///< the same in metres
  double likeness = 1;  ///< correlation of image and model, -1..1; 1 where the model is too plain
  bool blind = false;   ///< the model has contrast where the image has none
  int iterations = 0;
  bool accepted = false;
  std::string reason;  ///< why not accepted: empty, else a short ASCII phrase with numbers
};

/// Robust frame-to-model alignment (paper section V): point-to-plane and photometric rows, coarse
/// to fine, Gauss-Newton with T <- T exp(d), started at `start`, which is also a weak prior with
/// covariance `start_cov` (right perturbation). `min_inliers`: least weighted count of inliers for
/// acceptance. A result that is not accepted has T_PC = start and covariance = start_cov.
TrackResult alignToModel(const std::vector<TrackReference>& reference,
                         const std::vector<TrackLevel>& frame, const WeightPyramid& weights,
                         const SE3& start, const Mat6& start_cov, double min_inliers,
                         const FusionConfig& config);

/// Kernel by the name in the configuration; throws std::invalid_argument for another.
RobustKernel kernelByName(const std::string& name);

/// Input of the kernel for one level at T_PC, robust scales and brightness at their neutral values.
KernelInput kernelInput(const TrackLevel& level, const Image<float>& weight, const SE3& T_PC,
                        const FusionConfig& config);

}  // namespace rf
