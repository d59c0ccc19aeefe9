// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "geometry/se3.hpp"

namespace rf {

/// Pinhole camera with optional Brown-Conrady distortion. Optical frame: x right, y down, z
/// forward. Pixel centres have integer coordinates: u = fx x/z + cx, v = fy y/z + cy.
struct Camera {
  int width = 0;                                       ///< pixels
  int height = 0;                                      ///< pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;               ///< pixels
  std::array<double, 5> distortion = {0, 0, 0, 0, 0};  ///< k1 k2 p1 p2 k3 (OpenCV order)

  bool hasDistortion() const;
  /// The same pinhole without distortion.
  Camera undistorted() const;
  /// The camera of an image reduced by the integer factor f in both directions, each new pixel
  /// covering an f x f block: c' = (c + 0.5) / f - 0.5. Sizes are rounded down.
  Camera reduced(int f) const;
  Eigen::Vector2d project(const Vec3& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy};
  }
  Vec3 backProject(double u, double v, double z) const {
    return {(u - cx) / fx * z, (v - cy) / fy * z, z};
  }
  /// Distorted pixel position of an ideal (undistorted) pixel position.
  Eigen::Vector2d distort(const Eigen::Vector2d& ideal_px) const;
  /// Inverse of distort by fixed-point iteration (30 steps or 1e-6 px).
  Eigen::Vector2d undistort(const Eigen::Vector2d& distorted_px) const;
  /// Empty when the calibration is usable, else what is wrong, naming field, value and rule.
  std::optional<std::string> problem() const;
  bool operator==(const Camera&) const = default;
};

/// No image, in any file or message, may be larger than this in either direction.
inline constexpr int kMaxImageSide = 8192;

}  // namespace rf
