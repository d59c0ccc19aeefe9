// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "simulation/manipulator.hpp"

namespace rf::sim {

/// Wheels, their slip and their encoders. Four mecanum wheels or two driven ones; each wheel turns
/// a constant share more or less than the way it goes (its radius is not known exactly), slips by a
/// share that wanders, and now and then spins for a moment. Lateral slip is the base's own
/// (BaseTrack): wheels do not see it.
struct WheelModel {
  double radius = 0.08;        ///< metres
  double half_track = 0.25;    ///< wheels left and right of the middle, metres
  double half_base = 0.21;     ///< wheels ahead of and behind it
  int ticks = 2048;            ///< of an encoder, a turn
  double scale_sigma = 0.008;  ///< standard deviation of the constant share
  double slip_sigma = 0.03;    ///< of the wandering share
  double slip_memory = 0.5;    ///< seconds after which it is forgotten
  double spins_per_s = 0.15;   ///< moments of spinning, per wheel
  double spin_share = 0.15;    ///< more than the way it goes
  double spin_seconds = 0.25;
};

/// A pose of the base by its own wheels.
struct WheelPose {
  double seconds = 0;
  SE3 T_WB;  ///< starts with the true pose, drifts
};

/// What a base says of its way: wheel counts, read `rate` times a second, integrated. From `begin`
/// to `end` seconds of the choreography. The seed decides all errors.
std::vector<WheelPose> wheelOdometry(const Manipulator& robot, const WheelModel& model,
                                     double begin, double end, double rate, std::uint64_t seed);

}  // namespace rf::sim
