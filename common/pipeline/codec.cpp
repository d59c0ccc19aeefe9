// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/codec.hpp"

#include <turbojpeg.h>
#include <zlib.h>

#include <bit>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

#include "geometry/camera.hpp"

namespace rf {
namespace {

static_assert(std::endian::native == std::endian::little, "depth planes are copied as they are");
static_assert(sizeof(Rgb) == 3, "colour planes are copied as they are");

/// zlib's best ratio is 1032:1 and its smallest stream a few bytes.
constexpr std::size_t kMaxZlibRatio = 1032;

struct TurboHandle {
  explicit TurboHandle(tjhandle h) : handle(h) {
    if (handle == nullptr) throw std::runtime_error("libturbojpeg: cannot create a handle");
  }
  ~TurboHandle() { tjDestroy(handle); }
  TurboHandle(const TurboHandle&) = delete;
  TurboHandle& operator=(const TurboHandle&) = delete;
  tjhandle handle;
};

std::string sizeText(long width, long height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

bool sizeIsSane(int width, int height) {
  return width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide;
}

std::span<const std::uint8_t> bytesOf(const Image<std::uint16_t>& image) {
  return {reinterpret_cast<const std::uint8_t*>(image.data()), image.size() * 2};
}

std::vector<std::uint8_t> encodeJpeg(const Image<Rgb>& colour, int quality) {
  const TurboHandle turbo(tjInitCompress());
  unsigned long size = tjBufSize(colour.width(), colour.height(), TJSAMP_420);
  std::vector<std::uint8_t> jpeg(size);
  std::uint8_t* out = jpeg.data();
  if (tjCompress2(turbo.handle, reinterpret_cast<const std::uint8_t*>(colour.data()),
                  colour.width(), 0, colour.height(), TJPF_RGB, &out, &size, TJSAMP_420, quality,
                  TJFLAG_NOREALLOC) != 0) {
    throw std::runtime_error(std::string("libturbojpeg: ") + tjGetErrorStr2(turbo.handle));
  }
  jpeg.resize(size);
  return jpeg;
}

Result<Image<Rgb>> decodeJpeg(const std::vector<std::uint8_t>& jpeg, int width, int height) {
  const TurboHandle turbo(tjInitDecompress());
  int w = 0;
  int h = 0;
  int subsampling = 0;
  int colour_space = 0;
  if (tjDecompressHeader3(turbo.handle, jpeg.data(), jpeg.size(), &w, &h, &subsampling,
                          &colour_space) != 0) {
    return Result<Image<Rgb>>::failure(std::string("colour: not a JPEG image: ") +
                                       tjGetErrorStr2(turbo.handle));
  }
  if (w != width || h != height) {
    return Result<Image<Rgb>>::failure("colour: the JPEG image is " + sizeText(w, h) +
                                       ", the frame " + sizeText(width, height));
  }
  Image<Rgb> colour(width, height);
  if (tjDecompress2(turbo.handle, jpeg.data(), jpeg.size(),
                    reinterpret_cast<std::uint8_t*>(colour.data()), width, 0, height, TJPF_RGB,
                    0) != 0) {
    return Result<Image<Rgb>>::failure(std::string("colour: damaged JPEG: ") +
                                       tjGetErrorStr2(turbo.handle));
  }
  return colour;
}

Result<Image<Rgb>> decodeRaw(const EncodedFrame& encoded) {
  const std::size_t want =
      static_cast<std::size_t>(encoded.width) * static_cast<std::size_t>(encoded.height) * 3;
  if (encoded.colour.size() != want) {
    return Result<Image<Rgb>>::failure("colour: " + std::to_string(encoded.colour.size()) +
                                       " bytes, but " + sizeText(encoded.width, encoded.height) +
                                       " raw pixels need " + std::to_string(want));
  }
  Image<Rgb> colour(encoded.width, encoded.height);
  std::memcpy(reinterpret_cast<std::uint8_t*>(colour.data()), encoded.colour.data(), want);
  if (encoded.colour_format == ColourFormat::kBgr) {
    for (Rgb& p : colour) std::swap(p.r, p.b);
  }
  return colour;
}

Result<Image<std::uint16_t>> decodeDepth(const EncodedFrame& encoded) {
  using Depth = Result<Image<std::uint16_t>>;
  const std::size_t want =
      static_cast<std::size_t>(encoded.width) * static_cast<std::size_t>(encoded.height) * 2;
  std::vector<std::uint8_t> inflated;
  const std::vector<std::uint8_t>* bytes = &encoded.depth;
  if (encoded.depth_zipped) {
    auto result = inflateBytes(encoded.depth, want);
    if (!result) return Depth::failure("depth: " + result.error);
    inflated = std::move(*result);
    bytes = &inflated;
  }
  if (bytes->size() != want) {
    return Depth::failure("depth: " + std::to_string(bytes->size()) + " bytes, but " +
                          sizeText(encoded.width, encoded.height) + " pixels need " +
                          std::to_string(want));
  }
  Image<std::uint16_t> depth(encoded.width, encoded.height);
  std::memcpy(depth.data(), bytes->data(), want);
  return depth;
}

}  // namespace

std::vector<std::uint8_t> deflateBytes(std::span<const std::uint8_t> bytes, int level) {
  uLongf size = compressBound(bytes.size());
  std::vector<std::uint8_t> zipped(size);
  const int status = compress2(zipped.data(), &size, bytes.data(), bytes.size(), level);
  if (status != Z_OK)
    throw std::runtime_error("zlib: compress2 failed with " + std::to_string(status));
  zipped.resize(size);
  return zipped;
}

Result<std::vector<std::uint8_t>> inflateBytes(std::span<const std::uint8_t> zipped,
                                               std::size_t size) {
  using Bytes = Result<std::vector<std::uint8_t>>;
  if (size > (zipped.size() + 1) * kMaxZlibRatio) {
    return Bytes::failure(std::to_string(zipped.size()) + " zlib bytes cannot hold " +
                          std::to_string(size));
  }
  std::vector<std::uint8_t> bytes(size + 1);  // one more, so that an overlong stream shows
  uLongf written = bytes.size();
  const int status = uncompress(bytes.data(), &written, zipped.data(), zipped.size());
  if (status != Z_OK || written != size) {
    return Bytes::failure("zlib stream is damaged, truncated, or does not hold " +
                          std::to_string(size) + " bytes");
  }
  bytes.resize(size);
  return bytes;
}

EncodedFrame encode(const RgbdFrame& frame, const CodecOptions& options) {
  const int width = frame.depth_mm.width();
  const int height = frame.depth_mm.height();
  if (!sizeIsSane(width, height) || frame.colour.width() != width ||
      frame.colour.height() != height) {
    throw std::invalid_argument("frame " + std::to_string(frame.seq) + ": colour is " +
                                sizeText(frame.colour.width(), frame.colour.height()) + ", depth " +
                                sizeText(width, height) + "; both must be equal, 1 to " +
                                std::to_string(kMaxImageSide) + " pixels a side");
  }
  EncodedFrame out;
  out.utime = frame.utime;
  out.colour_utime = frame.colour_utime;
  out.seq = frame.seq;
  out.width = width;
  out.height = height;
  if (options.lossless) {
    out.colour_format = ColourFormat::kRgb;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(frame.colour.data());
    out.colour.assign(bytes, bytes + frame.colour.size() * 3);
  } else {
    out.colour = encodeJpeg(frame.colour, options.jpeg_quality);
  }
  out.depth = deflateBytes(bytesOf(frame.depth_mm), options.depth_zlib_level);
  return out;
}

Result<RgbdFrame> decode(const EncodedFrame& encoded) {
  using Frame = Result<RgbdFrame>;
  if (!sizeIsSane(encoded.width, encoded.height)) {
    return Frame::failure("image size " + sizeText(encoded.width, encoded.height) +
                          " is not within 1 to " + std::to_string(kMaxImageSide) +
                          " pixels a side");
  }
  auto depth = decodeDepth(encoded);  // first: its size check bounds what the header may claim
  if (!depth) return Frame::failure(depth.error);
  auto colour = encoded.colour_format == ColourFormat::kJpeg
                    ? decodeJpeg(encoded.colour, encoded.width, encoded.height)
                    : decodeRaw(encoded);
  if (!colour) return Frame::failure(colour.error);
  RgbdFrame frame;
  frame.utime = encoded.utime;
  frame.colour_utime = encoded.colour_utime;
  frame.seq = encoded.seq;
  frame.colour = std::move(*colour);
  frame.depth_mm = std::move(*depth);
  return frame;
}

RgbdFrame roundTrip(const RgbdFrame& frame, const CodecOptions& options) {
  if (options.lossless) return frame;
  RgbdFrame out = frame;
  const auto jpeg = encodeJpeg(frame.colour, options.jpeg_quality);
  auto colour = decodeJpeg(jpeg, frame.colour.width(), frame.colour.height());
  if (!colour) throw std::runtime_error("codec: own JPEG does not decode: " + colour.error);
  out.colour = std::move(*colour);
  return out;
}

}  // namespace rf
