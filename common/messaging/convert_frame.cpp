// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <stdexcept>

#include "messaging/check.hpp"
#include "messaging/conversions.hpp"

namespace rf {
namespace {

using bot_core::image_t;
using bot_core::images_t;

constexpr const char* kSeqKey = "rf_seq";
constexpr int kMaxImages = 16;

bot_core::image_metadata_t seqMetadata(std::int64_t seq) {
  bot_core::image_metadata_t out;
  out.key = kSeqKey;
  out.n = 8;
  for (int shift = 56; shift >= 0; shift -= 8) {
    out.value.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(seq) >> shift));
  }
  return out;
}

/// -1 when the image carries no count.
std::int64_t seqOf(const image_t& image) {
  for (const auto& entry : image.metadata) {
    if (entry.key != kSeqKey || entry.value.size() != 8) continue;
    std::uint64_t seq = 0;
    for (const std::uint8_t byte : entry.value) seq = seq << 8U | byte;
    return static_cast<std::int64_t>(seq);
  }
  return -1;
}

image_t makeImage(std::int64_t utime, const EncodedFrame& frame, int bytes_per_pixel, int format,
                  const std::vector<std::uint8_t>& data) {
  image_t out;
  out.utime = utime;
  out.width = frame.width;
  out.height = frame.height;
  out.row_stride = frame.width * bytes_per_pixel;
  out.pixelformat = format;
  out.size = static_cast<std::int32_t>(data.size());
  out.data = data;
  out.nmetadata = 0;
  return out;
}

std::int32_t pixelformatOf(ColourFormat format) {
  switch (format) {
    case ColourFormat::kRgb:
      return image_t::PIXEL_FORMAT_RGB;
    case ColourFormat::kBgr:
      return image_t::PIXEL_FORMAT_BGR;
    case ColourFormat::kJpeg:
      break;
  }
  return image_t::PIXEL_FORMAT_MJPEG;
}

std::optional<ColourFormat> colourFormatOf(std::int32_t pixelformat) {
  switch (pixelformat) {
    case image_t::PIXEL_FORMAT_MJPEG:
      return ColourFormat::kJpeg;
    case image_t::PIXEL_FORMAT_RGB:
      return ColourFormat::kRgb;
    case image_t::PIXEL_FORMAT_BGR:
      return ColourFormat::kBgr;
    default:
      return std::nullopt;
  }
}

void checkSize(Check& check, const char* member, std::int32_t width, std::int32_t height) {
  check.rule(width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide,
             fmt::format("{} is {}x{}, must be 1 to {} pixels a side", member, width, height,
                         kMaxImageSide));
}

}  // namespace

Result<images_t> toMessage(const EncodedFrame& frame) {
  Check check("frame");
  checkSize(check, "size", frame.width, frame.height);
  check.rule(frame.colour.size() < (1U << 30U) && frame.depth.size() < (1U << 30U),
             "larger than 1 GiB");
  if (!check.good()) return Result<images_t>::failure(check.problem());
  images_t out;
  out.utime = frame.utime;
  out.n_images = 2;
  out.image_types = {images_t::LEFT,
                     frame.depth_zipped ? images_t::DEPTH_MM_ZIPPED : images_t::DEPTH_MM};
  out.images.push_back(
      makeImage(frame.colour_utime, frame, 3, pixelformatOf(frame.colour_format), frame.colour));
  out.images.push_back(
      makeImage(frame.utime, frame, 2, image_t::PIXEL_FORMAT_INVALID, frame.depth));
  if (frame.seq >= 0) {
    out.images[1].nmetadata = 1;
    out.images[1].metadata.push_back(seqMetadata(frame.seq));
  }
  return out;
}

Result<EncodedFrame> toValue(const images_t& message) {
  using Frame = Result<EncodedFrame>;
  Check check("images_t");
  check.rule(
      message.images.size() == message.image_types.size() && message.images.size() <= kMaxImages,
      fmt::format("{} images", message.images.size()));
  const image_t* colour = nullptr;
  const image_t* depth = nullptr;
  bool zipped = false;
  for (std::size_t i = 0; check.good() && i < message.images.size(); ++i) {
    const auto type = message.image_types[i];
    if (type == images_t::LEFT && colour == nullptr) colour = &message.images[i];
    if ((type == images_t::DEPTH_MM || type == images_t::DEPTH_MM_ZIPPED) && depth == nullptr) {
      depth = &message.images[i];
      zipped = type == images_t::DEPTH_MM_ZIPPED;
    }
  }
  check.rule(colour != nullptr, "no image of type LEFT (colour)");
  check.rule(depth != nullptr, "no image of type DEPTH_MM or DEPTH_MM_ZIPPED");
  if (!check.good()) return Frame::failure(check.problem());
  const auto format = colourFormatOf(colour->pixelformat);
  check.rule(format.has_value(), fmt::format("colour has pixelformat {}, must be MJPEG, RGB or BGR",
                                             colour->pixelformat));
  checkSize(check, "depth", depth->width, depth->height);
  check.rule(colour->width == depth->width && colour->height == depth->height,
             fmt::format("colour is {}x{}, depth {}x{}; they must be registered", colour->width,
                         colour->height, depth->width, depth->height));
  if (!check.good()) return Frame::failure(check.problem());
  EncodedFrame out;
  out.utime = message.utime;
  out.colour_utime = colour->utime;
  out.seq = seqOf(*depth);
  out.width = depth->width;
  out.height = depth->height;
  out.colour_format = *format;
  out.colour = colour->data;
  out.depth_zipped = zipped;
  out.depth = depth->data;
  return out;
}

Result<rigidfusion::camera_t> toMessage(const CameraInfo& info) {
  Check check("camera");
  check.text("source", info.source);
  if (const auto problem = info.camera.problem()) check.rule(false, *problem);
  if (!check.good()) return Result<rigidfusion::camera_t>::failure(check.problem());
  rigidfusion::camera_t out;
  out.utime = info.utime;
  out.source = info.source;
  out.width = info.camera.width;
  out.height = info.camera.height;
  out.fx = info.camera.fx;
  out.fy = info.camera.fy;
  out.cx = info.camera.cx;
  out.cy = info.camera.cy;
  for (std::size_t i = 0; i < 5; ++i) out.distortion[i] = info.camera.distortion[i];
  return out;
}

Result<CameraInfo> toValue(const rigidfusion::camera_t& message) {
  CameraInfo out;
  out.utime = message.utime;
  out.source = message.source;
  out.camera.width = message.width;
  out.camera.height = message.height;
  out.camera.fx = message.fx;
  out.camera.fy = message.fy;
  out.camera.cx = message.cx;
  out.camera.cy = message.cy;
  for (std::size_t i = 0; i < 5; ++i) out.camera.distortion[i] = message.distortion[i];
  Check check("camera_t");
  check.text("source", out.source);
  if (const auto problem = out.camera.problem()) check.rule(false, *problem);
  if (!check.good()) return Result<CameraInfo>::failure(check.problem());
  return out;
}

Result<rigidfusion::frame_tick_t> toMessage(const FrameTick& tick) {
  Check check("tick");
  check.text("reason", tick.reason);
  check.rule(tick.seq >= 0, fmt::format("seq is {}, must not be negative", tick.seq));
  if (!check.good()) return Result<rigidfusion::frame_tick_t>::failure(check.problem());
  rigidfusion::frame_tick_t out;
  out.utime = tick.utime;
  out.colour_utime = tick.colour_utime;
  out.seq = tick.seq;
  out.state = static_cast<std::int32_t>(tick.state);
  out.reason = tick.reason;
  return out;
}

Result<FrameTick> toValue(const rigidfusion::frame_tick_t& message) {
  Check check("frame_tick_t");
  check.text("reason", message.reason);
  check.rule(message.seq >= 0, fmt::format("seq is {}, must not be negative", message.seq));
  check.range("state", message.state, 1, 3);
  if (!check.good()) return Result<FrameTick>::failure(check.problem());
  return FrameTick{message.utime, message.colour_utime, message.seq,
                   static_cast<TickState>(message.state), message.reason};
}

}  // namespace rf
