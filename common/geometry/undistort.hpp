// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"

namespace rf {

/// Resamples images of a camera with lens distortion to the same pinhole without it
/// (Camera::undistorted()). The look-up tables are made once; the calls are const, deterministic
/// for every thread count and may run from several threads at once. Without distortion both calls
/// copy.
class Undistorter {
 public:
  /// Throws std::invalid_argument when the calibration is unusable.
  explicit Undistorter(const Camera& camera);

  const Camera& camera() const { return camera_; }  ///< the undistorted one

  /// Bilinear (weights in 1/256); black where the source pixel would lie outside the image. Throws
  /// std::invalid_argument when the image's size is not the camera's.
  Image<Rgb> colour(const Image<Rgb>& distorted) const;

  /// Nearest neighbour (depths are never mixed); 0 outside. Throws as colour() does.
  Image<std::uint16_t> depth(const Image<std::uint16_t>& distorted) const;

 private:
  struct Tap {
    std::int32_t top_left = -1;  ///< source index of the 2x2 block, -1 = outside
    std::uint16_t right = 0;     ///< weight of its right column, 0..256
    std::uint16_t bottom = 0;    ///< weight of its bottom row, 0..256
  };

  Camera camera_;
  bool identity_ = true;
  std::vector<Tap> taps_;
  std::vector<std::int32_t> nearest_;  ///< source index, -1 = outside
};

}  // namespace rf
