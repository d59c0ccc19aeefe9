// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/moving_pixels.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace rf {
namespace {

constexpr std::uint8_t kTrulyDynamic = 2;
constexpr double kNearest = 0.05;  // metres before the camera

}  // namespace

double MapOnMoving::share() const {
  return surfels == 0 ? 0.0 : static_cast<double>(on_moving) / static_cast<double>(surfels);
}

MovingPixels::MovingPixels(const std::vector<SurfelPoint>& map, const Camera& camera, double limit)
    : map_(map), camera_(camera), limit_(limit), marked_(map.size(), 0) {}

bool MovingPixels::onMoving(const SurfelPoint& s, const MaskedDepth& frame, const SE3& T_CW) const {
  const Vec3 p = T_CW * Vec3(s.x, s.y, s.z);
  if (!(p.z() > kNearest)) return false;
  const Eigen::Vector2d pixel = camera_.distort(camera_.project(p)).array().round();
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < camera_.width &&
        pixel.y() < camera_.height)) {
    return false;
  }
  const auto u = static_cast<int>(pixel.x());
  const auto v = static_cast<int>(pixel.y());
  if (frame.truth(u, v) != kTrulyDynamic || frame.depth_mm(u, v) == 0) return false;
  return std::abs(1e-3 * frame.depth_mm(u, v) - p.z()) <= limit_;
}

void MovingPixels::add(const MaskedDepth& frame) {
  const auto fits = [&](const auto& image) {
    return image.width() == camera_.width && image.height() == camera_.height;
  };
  if (!fits(frame.truth) || !fits(frame.depth_mm)) {
    throw std::invalid_argument("mask or depth image: must be of the camera's size");
  }
  ++frames_;
  const SE3 T_CW = frame.T_WC.inverse();
  for (std::size_t i = 0; i < map_.size(); ++i) {
    if (marked_[i] == 0 && onMoving(map_[i], frame, T_CW)) marked_[i] = 1;
  }
}

MapOnMoving MovingPixels::result() const {
  return {frames_, map_.size(),
          static_cast<std::size_t>(std::count(marked_.begin(), marked_.end(), std::uint8_t{1}))};
}

}  // namespace rf
