// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/image_files.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "datasets/error.hpp"
#include "geometry/camera.hpp"

namespace rf {
namespace {

constexpr std::size_t kMaxImageBytes = std::size_t{64} << 20;
constexpr int kPngCompression = 1;

using Bytes = std::vector<std::uint8_t>;

int bigEndian(const std::uint8_t* p, int bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value = (value << 8) | p[i];
  return value > 0x7fffffffU ? -1 : static_cast<int>(value);
}

constexpr std::array<std::uint8_t, 8> kPngMagic = {0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a};

std::optional<ImageHeader> parsePng(const std::uint8_t* data, std::size_t size) {
  if (size < 29 || std::memcmp(data + 12, "IHDR", 4) != 0) return std::nullopt;
  ImageHeader header{bigEndian(data + 16, 4), bigEndian(data + 20, 4), data[24], 0};
  switch (data[25]) {
    case 0:
      header.channels = 1;
      break;
    case 2:
      header.channels = 3;
      break;
    case 3:
      header.channels = 3;
      break;  // palette
    case 4:
      header.channels = 2;
      break;
    case 6:
      header.channels = 4;
      break;
    default:
      return std::nullopt;
  }
  return header;
}

std::optional<ImageHeader> parseJpeg(const std::uint8_t* data, std::size_t size) {
  std::size_t at = 2;
  while (at + 4 <= size && data[at] == 0xff) {
    const std::uint8_t marker = data[at + 1];
    if (marker == 0xff) {
      ++at;
      continue;
    }
    const bool is_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame) {
      if (at + 10 > size) return std::nullopt;
      return ImageHeader{bigEndian(data + at + 7, 2), bigEndian(data + at + 5, 2), data[at + 4],
                         data[at + 9]};
    }
    at += 2 + static_cast<std::size_t>(bigEndian(data + at + 2, 2));
  }
  return std::nullopt;
}

bool isJpeg(const Bytes& bytes) { return bytes.size() > 2 && bytes[0] == 0xff && bytes[1] == 0xd8; }

Bytes readBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw DatasetError(path + ": cannot be opened for reading");
  const std::streamoff size = file.tellg();
  if (size < 0) throw DatasetError(path + ": cannot be read");
  if (static_cast<std::uint64_t>(size) > kMaxImageBytes) {
    throw DatasetError(path + ": larger than 64 MiB");
  }
  Bytes bytes(static_cast<std::size_t>(size));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(bytes.data()), size);
  if (!file) throw DatasetError(path + ": cannot be read");
  return bytes;
}

ImageHeader headerOf(const std::string& path, const Bytes& bytes) {
  const auto header = parseImageHeader(bytes.data(), bytes.size());
  if (!header) throw DatasetError(path + ": is no PNG or JPEG image");
  return *header;
}

/// True when the end of the file is there: decoders of both formats are lenient about it.
bool isComplete(const Bytes& bytes) {
  static constexpr std::array<std::uint8_t, 4> kPngEnd = {'I', 'E', 'N', 'D'};
  static constexpr std::array<std::uint8_t, 2> kJpegEnd = {0xff, 0xd9};
  const auto tail = bytes.end() - std::min<std::ptrdiff_t>(64, std::ssize(bytes));
  if (isJpeg(bytes)) {
    return std::search(tail, bytes.end(), kJpegEnd.begin(), kJpegEnd.end()) != bytes.end();
  }
  return std::search(tail, bytes.end(), kPngEnd.begin(), kPngEnd.end()) != bytes.end();
}

cv::Mat decode(const std::string& path, const Bytes& bytes, int flags) {
  cv::Mat image;
  try {
    image = cv::imdecode(bytes, flags);
  } catch (const cv::Exception& e) {
    throw DatasetError(path + ": cannot be decoded: " + e.err);
  }
  if (image.empty()) throw DatasetError(path + ": cannot be decoded: damaged or truncated");
  return image;
}

cv::Mat readChecked(const std::string& path, int width, int height, int bits, int channels,
                    int flags) {
  const Bytes bytes = readBytes(path);
  const ImageHeader header = headerOf(path, bytes);
  if (header.width != width || header.height != height) {
    throw DatasetError(fmt::format("{}: image size {}x{}: must be {}x{} as the camera says", path,
                                   header.width, header.height, width, height));
  }
  if (bits != 0 && (header.bits != bits || header.channels != channels)) {
    throw DatasetError(fmt::format("{}: {} channel(s) of {} bit: must be {} of {} bit", path,
                                   header.channels, header.bits, channels, bits));
  }
  if (!isComplete(bytes)) throw DatasetError(path + ": is truncated");
  cv::Mat image = decode(path, bytes, flags);
  if (image.cols != width || image.rows != height) {
    throw DatasetError(path + ": decoded size differs from its header's");
  }
  return image;
}

template <class T>
Image<T> copyRows(const cv::Mat& mat) {
  Image<T> image(mat.cols, mat.rows);
  for (int v = 0; v < mat.rows; ++v) {
    std::memcpy(image.row(v), mat.ptr(v), static_cast<std::size_t>(mat.cols) * sizeof(T));
  }
  return image;
}

void writePng(const std::string& path, const cv::Mat& mat) {
  Bytes bytes;
  try {
    if (mat.empty() ||
        !cv::imencode(".png", mat, bytes, {cv::IMWRITE_PNG_COMPRESSION, kPngCompression})) {
      throw DatasetError(path + ": image cannot be encoded");
    }
  } catch (const cv::Exception& e) {
    throw DatasetError(path + ": image cannot be encoded: " + e.err);
  }
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  file.write(reinterpret_cast<const char*>(bytes.data()), std::ssize(bytes));
  file.flush();
  if (!file) throw DatasetError(path + ": cannot be written");
}

template <class T>
cv::Mat wrap(const Image<T>& image, int type) {
  // OpenCV has no read-only view; the encoder does not write.
  return {image.height(), image.width(), type, const_cast<T*>(image.data())};
}

}  // namespace

std::optional<ImageHeader> parseImageHeader(const std::uint8_t* data, std::size_t size) {
  std::optional<ImageHeader> header;
  if (size > kPngMagic.size() && std::equal(kPngMagic.begin(), kPngMagic.end(), data)) {
    header = parsePng(data, size);
  } else if (size > 2 && data[0] == 0xff && data[1] == 0xd8) {
    header = parseJpeg(data, size);
  }
  if (header && (header->width <= 0 || header->height <= 0)) return std::nullopt;
  return header;
}

ImageHeader readImageHeader(const std::string& path) { return headerOf(path, readBytes(path)); }

Image<Rgb> readColourImage(const std::string& path, int width, int height) {
  const cv::Mat bgr =
      readChecked(path, width, height, 0, 0, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return copyRows<Rgb>(rgb);
}

Image<std::uint16_t> readDepthImage(const std::string& path, int width, int height) {
  return copyRows<std::uint16_t>(readChecked(path, width, height, 16, 1, cv::IMREAD_UNCHANGED));
}

Image<std::uint8_t> readGreyImage(const std::string& path, int width, int height) {
  return copyRows<std::uint8_t>(readChecked(path, width, height, 8, 1, cv::IMREAD_UNCHANGED));
}

void writeColourImage(const std::string& path, const Image<Rgb>& image) {
  if (image.empty()) throw DatasetError(path + ": image is empty");
  cv::Mat bgr;
  cv::cvtColor(wrap(image, CV_8UC3), bgr, cv::COLOR_RGB2BGR);
  writePng(path, bgr);
}

void writeDepthImage(const std::string& path, const Image<std::uint16_t>& image) {
  writePng(path, wrap(image, CV_16UC1));
}

void writeGreyImage(const std::string& path, const Image<std::uint8_t>& image) {
  writePng(path, wrap(image, CV_8UC1));
}

Image<std::uint16_t> depthToMillimetres(const Image<std::uint16_t>& raw, double depth_factor) {
  if (!(depth_factor > 0) || !std::isfinite(depth_factor)) {
    throw std::invalid_argument(
        fmt::format("depth_factor = {}: must be a positive number", depth_factor));
  }
  std::vector<std::uint16_t> table(65536);
  for (std::size_t i = 1; i < table.size(); ++i) {
    const double mm = std::round(static_cast<double>(i) / depth_factor * 1000.0);
    table[i] = static_cast<std::uint16_t>(std::clamp(mm, 1.0, 65535.0));
  }
  Image<std::uint16_t> depth_mm(raw.width(), raw.height());
  std::transform(raw.begin(), raw.end(), depth_mm.begin(),
                 [&](std::uint16_t value) { return table[value]; });
  return depth_mm;
}

}  // namespace rf
