// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "geometry/camera.hpp"

namespace rf {

/// What a dataset says of its sensor.
struct Calibration {
  Camera camera;
  double depth_factor = 0;  ///< raw depth units per metre (5000 in TUM files)
};

/// Reads `width height fx fy cx cy depth_factor` and optional `k1 k2 p1 p2 k3` (0 when absent) from
/// YAML. Throws DatasetError when a field is missing, unknown or out of range, or ConfigError when
/// the file is no YAML.
Calibration readCalibration(const std::string& path);

/// Writes the same file.
void writeCalibration(const std::string& path, const Calibration& calibration);

}  // namespace rf
