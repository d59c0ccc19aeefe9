// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/se3.hpp"

namespace rf {

/// A trajectory as the drift generator sees it: (microseconds, pose), times strictly increasing.
using DriftPose = std::pair<std::int64_t, SE3>;

/// Two sources must not drift alike: one stream each per seed.
enum class DriftStream : std::uint8_t { kCamera = 0, kObject = 1 };

/// What the simulated odometry does wrong.
struct DriftSpec {
  double translation_mps = 0;  ///< mean norm of the translational twist, m/s; the paper: 0.06
  double rotation_radps = 0;   ///< mean norm of the rotational twist, rad/s; the paper: 0.4
  std::uint64_t seed = 0;
  DriftStream stream = DriftStream::kCamera;
};

/// Adds simulated drift to a true trajectory, the "motion prior with drift" of the paper's
/// experiments: out[k+1] = out[k] * (in[k]^-1 in[k+1]) * exp(xi_k), where xi_k is a body-frame
/// twist. The paper gives mean norms alone; the nature is chosen so that its prior columns (ATE and
/// RPE) come out. Rotation is nearly white: a lasting 0.4 rad/s would turn the prior by 6 rad in
/// 15 s, and even the random walk of white noise would put its ATE above the paper's; the angle
/// that it adds up to is forgotten over 4 s. Translation is 30 % constant, the rest alike over
/// about 1 s (two equal first-order filters) with no mean over the first 15 s. Both live on a grid
/// of 1/30 s that starts at the first pose: xi_k is the integral
/// over (t_k, t_k+1), so the same seed gives the same drift at every sampling rate, and a cut that
/// begins at the same pose has the same drift as the whole. The mean norms over the first 15 s
/// equal the numbers of the spec.
///
/// The first pose is kept: the drifted trajectory lives in the world of its input.
/// Throws std::invalid_argument on a negative or non-finite rate, a non-finite pose, or times that
/// do not increase. Pure and thread-safe.
std::vector<DriftPose> addDrift(std::span<const DriftPose> trajectory, const DriftSpec& spec);

}  // namespace rf
