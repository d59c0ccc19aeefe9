// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/field_of_view.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace rf {
namespace {

constexpr double kMinAngle = 0.1;
constexpr double kMaxAngle = 3.0;

double focalLength(const char* name, int size, double angle) {
  if (!(angle >= kMinAngle && angle <= kMaxAngle)) {
    throw std::invalid_argument(
        fmt::format("{} field of view = {} rad: must be within {}..{}; give a calibration file",
                    name, angle, kMinAngle, kMaxAngle));
  }
  return size / 2.0 / std::tan(angle / 2);
}

}  // namespace

Camera cameraOfFieldOfView(int width, int height, double horizontal, double vertical) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = focalLength("horizontal", width, horizontal);
  camera.fy = focalLength("vertical", height, vertical);
  camera.cx = (width - 1) / 2.0;  // pixel centres are integers: the image spans -0.5..width-0.5
  camera.cy = (height - 1) / 2.0;
  if (const auto problem = camera.problem()) throw std::invalid_argument(*problem);
  return camera;
}

}  // namespace rf
