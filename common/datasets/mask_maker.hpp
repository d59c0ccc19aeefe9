// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"

namespace rf {

/// Values of a mask file.
inline constexpr std::uint8_t kMaskNoDepth = 0;
inline constexpr std::uint8_t kMaskStatic = 1;
inline constexpr std::uint8_t kMaskDynamic = 2;
inline constexpr std::uint8_t kMaskSelf = 3;  ///< the robot itself

/// Turns segmentation's scores (working resolution, lens distortion undone) into a mask of the
/// input image (full size, distorted as the sensor gave it).
class MaskMaker {
 public:
  explicit MaskMaker(const Camera& camera) : camera_(camera) {}

  /// Shape of the result: that of `depth_mm`, which must be the camera's. A pixel is kMaskNoDepth
  /// where the input depth is 0, else kMaskSelf where the nearest label is kSelfLabel, else
  /// kMaskDynamic where the nearest score is below 128, else kMaskStatic. `reduction`: input pixels
  /// per score pixel; an empty `label` has no robot. Throws std::invalid_argument when the sizes do
  /// not belong together. The pixel map is computed at the first call.
  Image<std::uint8_t> make(const Image<std::uint16_t>& depth_mm, const Image<std::uint8_t>& score,
                           const Image<std::uint8_t>& label, int reduction);

 private:
  void prepare(int width, int height, int reduction);

  Camera camera_;
  int score_width_ = 0;
  int score_height_ = 0;
  int reduction_ = 0;
  std::vector<std::uint32_t> score_index_;  ///< of each input pixel, row-major
};

}  // namespace rf
