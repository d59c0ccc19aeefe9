// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "geometry/image.hpp"

namespace rf {

/// What the header of an image file promises, read without decoding.
struct ImageHeader {
  int width = 0;
  int height = 0;
  int bits = 0;      ///< per channel
  int channels = 0;  ///< 1 grey, 3 colour, 2 and 4 with alpha
};

/// Header of PNG or JPEG bytes; nothing when they are neither or are cut off.
std::optional<ImageHeader> parseImageHeader(const std::uint8_t* data, std::size_t size);
/// The same for a file. Throws DatasetError when it cannot be read or is neither PNG nor JPEG.
ImageHeader readImageHeader(const std::string& path);

/// All three readers refuse (DatasetError naming the file and the rule): a file that is missing,
/// larger than 64 MiB, no PNG or JPEG, truncated or damaged, or of another size than asked. The
/// size is taken from the header, before anything of that size is allocated.
Image<Rgb> readColourImage(const std::string& path, int width, int height);
/// 16-bit single-channel PNG, raw units.
Image<std::uint16_t> readDepthImage(const std::string& path, int width, int height);
/// 8-bit single-channel PNG.
Image<std::uint8_t> readGreyImage(const std::string& path, int width, int height);

/// PNG writers with fixed settings: same pixels, same bytes. Throw DatasetError.
void writeColourImage(const std::string& path, const Image<Rgb>& image);
void writeDepthImage(const std::string& path, const Image<std::uint16_t>& image);
void writeGreyImage(const std::string& path, const Image<std::uint8_t>& image);

/// Raw depth to whole millimetres: round(raw / depth_factor * 1000), saturating at 65535; 0 stays
/// 0, and a measurement never becomes 0.
Image<std::uint16_t> depthToMillimetres(const Image<std::uint16_t>& raw, double depth_factor);

}  // namespace rf
