// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <OpenNI.h>

#include "geometry/image.hpp"
#include "values/result.hpp"

namespace rf {

/// The depth of an OpenNI2 frame in whole millimetres. Fails when the frame is not width x height,
/// is cropped, its bytes are fewer than its size needs, or its format is neither 1 mm nor 100 um.
Result<Image<std::uint16_t>> depthOf(const openni::VideoFrameRef& frame, int width, int height);

/// Its colour. Formats: RGB888, YUV422 (U Y V Y) and YUYV.
Result<Image<Rgb>> colourOf(const openni::VideoFrameRef& frame, int width, int height);

/// "RGB888", "DEPTH_1_MM" ...
const char* nameOf(openni::PixelFormat format);

/// A format that depthOf or colourOf reads; the lower the better, -1: none.
int rankOf(openni::PixelFormat format);

}  // namespace rf
