// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/depth_noise.hpp"

#include <algorithm>

namespace rf {
namespace {

// Whitened rms of inliers where the noise is the model's: 0.82 to 0.90 on orbit, overtake and
// straight (twice the noise: 1.5 to 1.77, half: 0.51 to 0.55); less than 1 for the mean over 2x2.
constexpr double kUsualRms = 0.9;
constexpr int kFrames = 30;      // a second
constexpr double kWidest = 4.0;  // beyond that a sensor has another model

}  // namespace

void DepthNoise::learn(double rms_sigma) {
  if (!(rms_sigma > 0)) return;
  frames_ = std::min(frames_ + 1, kFrames);
  mean_ += (rms_sigma * factor_ - mean_) / frames_;
  factor_ = std::clamp(mean_ / kUsualRms, start_, std::max(start_, kWidest));
}

}  // namespace rf
