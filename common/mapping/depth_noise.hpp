// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace rf {

/// How noisy depth is, as a factor on the sensor model's sigma, learnt from the residuals of frames
/// that were tracked against the map. A sensor that is noisier than its model else grows surfels
/// in front of every surface (what lies a gate before the map is new, what lies behind it is not),
/// and the map creeps along with the camera (docs/ALGORITHM.md). Within a sixth of the model the
/// model holds.
class DepthNoise {
 public:
  /// `start`: the configured factor, which the learnt one never falls below.
  explicit DepthNoise(double start) : start_(start), factor_(start) {}

  double factor() const { return factor_; }
  /// `rms_sigma`: whitened rms of the inliers of a frame, with the present factor in its sigmas.
  void learn(double rms_sigma);

 private:
  double start_;
  double factor_;
  double mean_ = 0;  ///< of the whitened rms with the model's own sigmas
  int frames_ = 0;
};

}  // namespace rf
