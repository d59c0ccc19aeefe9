// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/undistort.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "geometry/parallel.hpp"

namespace rf {
namespace {

constexpr int kOne = 256;  // fixed-point one of the bilinear weights

void requireSize(const char* what, int width, int height, const Camera& camera) {
  if (width == camera.width && height == camera.height) return;
  throw std::invalid_argument(std::string(what) + " size " + std::to_string(width) + "x" +
                              std::to_string(height) + ": must be the camera's " +
                              std::to_string(camera.width) + "x" + std::to_string(camera.height));
}

std::uint8_t blend(int a, int b, int c, int d, int right, int bottom) {
  const int top = a * (kOne - right) + b * right;
  const int low = c * (kOne - right) + d * right;
  return static_cast<std::uint8_t>((top * (kOne - bottom) + low * bottom + kOne * kOne / 2) /
                                   (kOne * kOne));
}

}  // namespace

Undistorter::Undistorter(const Camera& camera)
    : camera_(camera.undistorted()), identity_(!camera.hasDistortion()) {
  if (const auto problem = camera.problem()) throw std::invalid_argument(*problem);
  if (identity_) return;
  const std::size_t size =
      static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
  taps_.resize(size);
  nearest_.assign(size, -1);
  parallelRows(camera.height, [&](int v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d at = camera.distort({u, v});
      // A pixel covers half a unit around its centre; NaN fails these comparisons.
      const bool inside = at.x() >= -0.5 && at.y() >= -0.5 && at.x() < camera.width - 0.5 &&
                          at.y() < camera.height - 0.5;
      if (!inside) continue;
      const std::size_t i = static_cast<std::size_t>(v) * static_cast<std::size_t>(camera.width) +
                            static_cast<std::size_t>(u);
      const double x = std::clamp(at.x(), 0.0, camera.width - 1.0);
      const double y = std::clamp(at.y(), 0.0, camera.height - 1.0);
      const int x0 = std::min(static_cast<int>(x), camera.width - 2);
      const int y0 = std::min(static_cast<int>(y), camera.height - 2);
      taps_[i].top_left = y0 * camera.width + x0;
      taps_[i].right = static_cast<std::uint16_t>(std::lround((x - x0) * kOne));
      taps_[i].bottom = static_cast<std::uint16_t>(std::lround((y - y0) * kOne));
      nearest_[i] = static_cast<std::int32_t>(std::lround(y)) * camera.width +
                    static_cast<std::int32_t>(std::lround(x));
    }
  });
}

Image<Rgb> Undistorter::colour(const Image<Rgb>& distorted) const {
  requireSize("colour image", distorted.width(), distorted.height(), camera_);
  if (identity_) return distorted;
  Image<Rgb> out(camera_.width, camera_.height);
  parallelRows(camera_.height, [&](int v) {
    const Tap* taps = taps_.data() + static_cast<std::size_t>(v) * camera_.width;
    Rgb* row = out.row(v);
    for (int u = 0; u < camera_.width; ++u) {
      const Tap tap = taps[u];
      if (tap.top_left < 0) continue;
      const Rgb* top = distorted.data() + tap.top_left;
      const Rgb* low = top + camera_.width;
      row[u].r = blend(top[0].r, top[1].r, low[0].r, low[1].r, tap.right, tap.bottom);
      row[u].g = blend(top[0].g, top[1].g, low[0].g, low[1].g, tap.right, tap.bottom);
      row[u].b = blend(top[0].b, top[1].b, low[0].b, low[1].b, tap.right, tap.bottom);
    }
  });
  return out;
}

Image<std::uint16_t> Undistorter::depth(const Image<std::uint16_t>& distorted) const {
  requireSize("depth image", distorted.width(), distorted.height(), camera_);
  if (identity_) return distorted;
  Image<std::uint16_t> out(camera_.width, camera_.height);
  parallelRows(camera_.height, [&](int v) {
    const std::int32_t* source = nearest_.data() + static_cast<std::size_t>(v) * camera_.width;
    std::uint16_t* row = out.row(v);
    for (int u = 0; u < camera_.width; ++u) {
      row[u] = source[u] < 0 ? std::uint16_t{0} : distorted[static_cast<std::size_t>(source[u])];
    }
  });
  return out;
}

}  // namespace rf
