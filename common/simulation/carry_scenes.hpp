// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "simulation/world.hpp"

namespace rf::sim {

/// Puts the mobile manipulator with a carton into a room: body 1 is the carton (its frame in its
/// middle, x away from the robot while it is held straight, z up), the bodies after it are the
/// robot's links. `scene`: carry_omni, carry_diff, carry_head, calibrate_drive or
/// calibrate_grasp; others are left alone.
void buildCarryScene(World& world, const std::string& scene, std::uint64_t seed);

}  // namespace rf::sim
