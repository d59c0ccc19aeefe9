// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "values/frame.hpp"
#include "values/result.hpp"

namespace rf {

/// How the bytes of EncodedFrame::colour are to be read.
enum class ColourFormat : std::int8_t { kJpeg = 0, kRgb = 1, kBgr = 2 };

/// An RGB-D frame as it travels: colour compressed or raw, depth in whole millimetres.
struct EncodedFrame {
  std::int64_t utime = 0;         ///< microseconds, the depth image's
  std::int64_t colour_utime = 0;  ///< microseconds, the colour image's
  std::int64_t seq = 0;           ///< -1 when the sender does not count
  int width = 0;                  ///< pixels, of both images
  int height = 0;                 ///< pixels, of both images
  ColourFormat colour_format = ColourFormat::kJpeg;
  std::vector<std::uint8_t> colour;  ///< a JPEG stream, or width*height*3 bytes
  bool depth_zipped = true;
  std::vector<std::uint8_t> depth;  ///< little-endian uint16 millimetres, zlib-compressed or not
};

/// Options of encode.
struct CodecOptions {
  bool lossless = false;     ///< raw RGB instead of JPEG, for study
  int jpeg_quality = 90;     ///< 1..100
  int depth_zlib_level = 1;  ///< 1..9

  template <class V>
  void visit(V& v) {
    v("lossless", lossless, "-", "send raw colour instead of JPEG; messages grow to about 1 MB");
    v("jpeg_quality", jpeg_quality, 1, 100, "-", "JPEG quality of colour, 4:2:0");
    v("depth_zlib_level", depth_zlib_level, 1, 9, "-", "zlib level of depth");
  }
};

/// Compresses a frame. Throws std::invalid_argument when colour and depth differ in size, are empty
/// or larger than kMaxImageSide.
EncodedFrame encode(const RgbdFrame& frame, const CodecOptions& options = {});

/// Restores a frame, checking every size before it allocates. Deterministic. Depth is exact.
Result<RgbdFrame> decode(const EncodedFrame& encoded);

/// What the receiver of `frame` will see: colour through the codec, depth unchanged. The offline
/// run calls this so that it sees the same pixels as the processes.
RgbdFrame roundTrip(const RgbdFrame& frame, const CodecOptions& options = {});

/// zlib. Throws std::runtime_error only when zlib itself fails.
std::vector<std::uint8_t> deflateBytes(std::span<const std::uint8_t> bytes, int level);

/// Inverse of deflateBytes; the result must have exactly `size` bytes. Fails before allocating when
/// `size` is more than zlib can pack into the input.
Result<std::vector<std::uint8_t>> inflateBytes(std::span<const std::uint8_t> zipped,
                                               std::size_t size);

}  // namespace rf
