// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/camera.hpp"

#include <algorithm>
#include <cmath>

namespace rf {

bool Camera::hasDistortion() const {
  return std::any_of(distortion.begin(), distortion.end(), [](double d) { return d != 0.0; });
}

Camera Camera::undistorted() const {
  Camera c = *this;
  c.distortion = {0, 0, 0, 0, 0};
  return c;
}

Camera Camera::reduced(int f) const {
  Camera c = *this;
  c.width = width / f;
  c.height = height / f;
  c.fx = fx / f;
  c.fy = fy / f;
  c.cx = (cx + 0.5) / f - 0.5;
  c.cy = (cy + 0.5) / f - 0.5;
  return c;
}

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& ideal_px) const {
  const auto& [k1, k2, p1, p2, k3] = distortion;
  const double x = (ideal_px.x() - cx) / fx;
  const double y = (ideal_px.y() - cy) / fy;
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  return {fx * xd + cx, fy * yd + cy};
}

Eigen::Vector2d Camera::undistort(const Eigen::Vector2d& distorted_px) const {
  Eigen::Vector2d ideal = distorted_px;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector2d error = distort(ideal) - distorted_px;
    ideal -= error;
    if (error.norm() < 1e-6) break;
  }
  return ideal;
}

std::optional<std::string> Camera::problem() const {
  const auto say = [](const std::string& field, double value, const std::string& rule) {
    return "camera." + field + " = " + std::to_string(value) + ": " + rule;
  };
  if (width < 16 || width > kMaxImageSide)
    return say("width", width, "must be 16.." + std::to_string(kMaxImageSide));
  if (height < 16 || height > kMaxImageSide)
    return say("height", height, "must be 16.." + std::to_string(kMaxImageSide));
  if (!(fx > 0) || !std::isfinite(fx)) return say("fx", fx, "must be a positive number of pixels");
  if (!(fy > 0) || !std::isfinite(fy)) return say("fy", fy, "must be a positive number of pixels");
  if (!std::isfinite(cx) || cx < 0 || cx >= width)
    return say("cx", cx, "must lie inside the image");
  if (!std::isfinite(cy) || cy < 0 || cy >= height)
    return say("cy", cy, "must lie inside the image");
  for (double d : distortion) {
    if (!std::isfinite(d)) return say("distortion", d, "must be finite");
  }
  return std::nullopt;
}

}  // namespace rf
