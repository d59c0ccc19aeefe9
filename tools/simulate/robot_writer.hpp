// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>

#include "simulation/world.hpp"

namespace rf {

/// Writes what a robot records of itself, and the truth beside it, into `folder`, made when missing
/// (docs/SIMULATION.md, "The robot"): of the whole choreography, so that a cut of the frames has
/// the same bytes. `world` has a robot. `seed` decides slip and encoders. Throws std::runtime_error
/// that names the file.
void writeRobot(const std::filesystem::path& folder, const sim::World& world, std::uint64_t seed);

}  // namespace rf
