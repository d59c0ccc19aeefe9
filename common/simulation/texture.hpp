// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/image.hpp"

namespace rf::sim {

/// A picture with its reduced copies (each half the size of the one before), so that a far surface
/// is sampled without flicker. Stored as displayed (sRGB), sampled as linear light.
class Texture {
 public:
  /// Throws std::invalid_argument on an empty picture.
  explicit Texture(Image<Rgb> picture);

  int width() const { return levels_.front().width(); }
  int height() const { return levels_.front().height(); }

  /// Linear colour in 0..1 at (u, v) texels of the full picture, averaged over about `footprint`
  /// texels; the picture repeats, mirrored, beyond its borders.
  Eigen::Vector3f sample(float u, float v, float footprint) const;

 private:
  std::vector<Image<Rgb>> levels_;
};

/// Linear light (0..1) of a displayed value.
float linearFromSrgb(std::uint8_t value);

}  // namespace rf::sim
