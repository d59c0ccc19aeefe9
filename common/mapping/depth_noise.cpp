// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/depth_noise.hpp"

#include <algorithm>
#include <cmath>

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
  // The map is a mean of the frames before: at first as noisy as they.
  const double own = rms_sigma * factor_ / std::sqrt(1.0 + 1.0 / frames_);
  mean_ += (own - mean_) / frames_;
  const double measured = mean_ / kUsualRms;
  // Nothing up to 1.17, all of it from 1.25 on: a model is believed within what it varies by.
  const double counted = std::min(measured, 3.0 * measured - 2.5);
  factor_ = std::clamp(counted, start_, std::max(start_, kWidest));
}

}  // namespace rf
