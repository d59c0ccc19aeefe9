// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/image.hpp"

namespace rf {

/// Pixels on either side of a depth step between a body and its world, by which of both is nearer
/// there (the border ownership of figure and ground).
struct BorderSides {
  int body_nearer = 0;
  int body_farther = 0;
};

/// Counts them along rows and columns, over up to three pixels that have no depth: the shadow of a
/// structured-light sensor. `depth`: metres; a step is kDefaultDepthGate and more. `label`:
/// clusters on the same grid, indices into `gamma`, all others are left out. `gamma`: below 0.5 is
/// the body.
BorderSides borderSides(const Image<float>& depth, const Image<std::uint8_t>& label,
                        const std::vector<float>& gamma);

/// How unlikely a body behind its world is: the log odds of the sides, with ten pixels of either
/// seen before, so that a short border says little; none where the body is nearer along half of it.
double bodyBehind(const BorderSides& sides);

}  // namespace rf
