// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "simulation/simulator.hpp"
#include "values/frame.hpp"
#include "values/stamped_pose.hpp"

namespace rf {

/// A part of a simulated sequence with its truth, and priors that drift as in the paper. Without an
/// object in the scene, `object` and `object_prior` are empty.
struct SimulatedCut {
  std::vector<RgbdFrame> frames;
  std::vector<Image<std::uint8_t>> truth;  ///< masks
  std::vector<double> speed;               ///< of the object, m/s
  Trajectory camera, object, camera_prior, object_prior;
};

/// What the pipeline gets of a simulated frame: its images; times and seq stay unset.
RgbdFrame shown(const sim::SimulatedFrame& frame);

/// Renders `count` frames from `first` on, with two threads; `seed` is that of the drift.
SimulatedCut renderCut(const sim::Simulator& simulator, int first, int count, std::uint64_t seed);

/// One frame a call and nothing at the end, as runSequence asks for them. The cut outlives it.
std::function<std::optional<RgbdFrame>()> framesOf(const SimulatedCut& cut);

}  // namespace rf
