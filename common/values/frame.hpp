// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "geometry/image.hpp"

namespace rf {

/// One RGB-D frame as every stage sees it AFTER the codec (JPEG colour decoded, depth in whole
/// millimetres): the offline run and the processes see the same pixels. Colour and depth are
/// registered, of the camera's size, and still carry the lens distortion of the calibration.
struct RgbdFrame {
  std::int64_t utime = 0;         ///< microseconds, the DEPTH image's capture time
  std::int64_t colour_utime = 0;  ///< microseconds, the colour image's own capture time
  std::int64_t seq = 0;           ///< counts frames of a stream from 0; gaps mean loss
  Image<Rgb> colour;
  Image<std::uint16_t> depth_mm;  ///< 0 = no measurement
};

}  // namespace rf
