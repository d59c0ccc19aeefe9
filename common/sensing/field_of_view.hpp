// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/camera.hpp"

namespace rf {

/// The pinhole without distortion that sees these fields of view (radians, from edge to edge of the
/// image): f = size / 2 / tan(fov / 2), the principal point in the middle. Throws
/// std::invalid_argument unless the size is usable and both angles are within 0.1..3 rad.
Camera cameraOfFieldOfView(int width, int height, double horizontal, double vertical);

}  // namespace rf
