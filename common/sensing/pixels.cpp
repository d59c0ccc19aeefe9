// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/pixels.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include <fmt/format.h>

namespace rf {
namespace {

/// Empty, or why the frame cannot be read as width x height with `bytes_per_pixel`.
std::string fault(const openni::VideoFrameRef& frame, const char* kind, int width, int height,
                  int bytes_per_pixel) {
  if (frame.getWidth() != width || frame.getHeight() != height || frame.getCroppingEnabled()) {
    return fmt::format("the device sent {} of {}x{}{}: must be {}x{} as configured", kind,
                       frame.getWidth(), frame.getHeight(),
                       frame.getCroppingEnabled() ? " (cropped)" : "", width, height);
  }
  const long stride = frame.getStrideInBytes();
  const long row = static_cast<long>(width) * bytes_per_pixel;
  const long need = stride * (height - 1) + row;
  if (frame.getData() == nullptr || stride < row || frame.getDataSize() < need) {
    return fmt::format("the device sent {} bytes of {} in rows of {}: {}x{} needs {}",
                       frame.getDataSize(), kind, stride, width, height, row * height);
  }
  return {};
}

const std::uint8_t* rowOf(const openni::VideoFrameRef& frame, int v) {
  return static_cast<const std::uint8_t*>(frame.getData()) +
         static_cast<std::ptrdiff_t>(v) * frame.getStrideInBytes();
}

std::uint8_t clampByte(double value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L));
}

/// ITU-R BT.601, studio swing: Y 16..235.
Rgb rgbOfYuv(int y, int u, int v) {
  const double c = 1.164 * (y - 16);
  return {clampByte(c + 1.596 * (v - 128)), clampByte(c - 0.813 * (v - 128) - 0.391 * (u - 128)),
          clampByte(c + 2.018 * (u - 128))};
}

/// Two pixels of four bytes; `luma`: where the first Y is, Y and chroma alternate.
void yuvRow(const std::uint8_t* from, Rgb* to, int width, int luma) {
  const int chroma = 1 - luma;
  for (int u = 0; u + 1 < width; u += 2, from += 4) {
    to[u] = rgbOfYuv(from[luma], from[chroma], from[chroma + 2]);
    to[u + 1] = rgbOfYuv(from[luma + 2], from[chroma], from[chroma + 2]);
  }
}

}  // namespace

Result<Image<std::uint16_t>> depthOf(const openni::VideoFrameRef& frame, int width, int height) {
  using Depth = Result<Image<std::uint16_t>>;
  const auto format = frame.getVideoMode().getPixelFormat();
  if (format != openni::PIXEL_FORMAT_DEPTH_1_MM && format != openni::PIXEL_FORMAT_DEPTH_100_UM)
    return Depth::failure(
        fmt::format("depth in format {}: must be 1 mm or 100 um", nameOf(format)));
  if (auto why = fault(frame, "depth", width, height, 2); !why.empty())
    return Depth::failure(std::move(why));
  Image<std::uint16_t> depth(width, height);
  for (int v = 0; v < height; ++v)
    std::memcpy(depth.row(v), rowOf(frame, v), static_cast<std::size_t>(width) * 2);
  if (format == openni::PIXEL_FORMAT_DEPTH_100_UM) {
    for (std::uint16_t& d : depth) {
      if (d > 0) d = static_cast<std::uint16_t>(std::max(1, (d + 5) / 10));
    }
  }
  return depth;
}

Result<Image<Rgb>> colourOf(const openni::VideoFrameRef& frame, int width, int height) {
  using Colour = Result<Image<Rgb>>;
  const auto format = frame.getVideoMode().getPixelFormat();
  const bool yuv = format == openni::PIXEL_FORMAT_YUV422 || format == openni::PIXEL_FORMAT_YUYV;
  if (format != openni::PIXEL_FORMAT_RGB888 && !yuv)
    return Colour::failure(
        fmt::format("colour in format {}: must be RGB888, YUV422 or YUYV", nameOf(format)));
  if (auto why = fault(frame, "colour", width, height, yuv ? 2 : 3); !why.empty())
    return Colour::failure(std::move(why));
  if (yuv && width % 2 != 0) return Colour::failure("YUV colour of odd width");
  Image<Rgb> colour(width, height);
  for (int v = 0; v < height; ++v) {
    if (yuv) {
      yuvRow(rowOf(frame, v), colour.row(v), width, format == openni::PIXEL_FORMAT_YUYV ? 0 : 1);
    } else {
      std::memcpy(static_cast<void*>(colour.row(v)), rowOf(frame, v),
                  static_cast<std::size_t>(width) * 3);
    }
  }
  return colour;
}

const char* nameOf(openni::PixelFormat format) {
  switch (format) {
    case openni::PIXEL_FORMAT_DEPTH_1_MM:
      return "DEPTH_1_MM";
    case openni::PIXEL_FORMAT_DEPTH_100_UM:
      return "DEPTH_100_UM";
    case openni::PIXEL_FORMAT_RGB888:
      return "RGB888";
    case openni::PIXEL_FORMAT_YUV422:
      return "YUV422";
    case openni::PIXEL_FORMAT_YUYV:
      return "YUYV";
    case openni::PIXEL_FORMAT_GRAY8:
      return "GRAY8";
    case openni::PIXEL_FORMAT_GRAY16:
      return "GRAY16";
    case openni::PIXEL_FORMAT_JPEG:
      return "JPEG";
    default:
      return "SHIFT or unknown";
  }
}

int rankOf(openni::PixelFormat format) {
  switch (format) {
    case openni::PIXEL_FORMAT_DEPTH_1_MM:
    case openni::PIXEL_FORMAT_RGB888:
      return 0;
    case openni::PIXEL_FORMAT_DEPTH_100_UM:
    case openni::PIXEL_FORMAT_YUV422:
      return 1;
    case openni::PIXEL_FORMAT_YUYV:
      return 2;
    default:
      return -1;
  }
}

}  // namespace rf
