// SPDX-License-Identifier: BSD-3-Clause
#include "mask_folder.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "datasets/error.hpp"
#include "datasets/image_files.hpp"
#include "datasets/text.hpp"
#include "geometry/camera.hpp"

namespace rf {

namespace fs = std::filesystem;

std::map<std::int64_t, std::string> listMasks(const std::string& folder) {
  std::map<std::int64_t, std::string> masks;
  if (!fs::is_directory(folder)) return masks;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".png") continue;
    const auto utime = parseTimestamp(entry.path().stem().string());
    if (utime) masks[*utime] = entry.path().string();
  }
  return masks;
}

Image<std::uint8_t> readMask(const std::string& path) {
  const ImageHeader header = readImageHeader(path);
  if (header.width > kMaxImageSide || header.height > kMaxImageSide) {
    throw DatasetError(fmt::format("{}: image size {}x{}: must be at most {}", path, header.width,
                                   header.height, kMaxImageSide));
  }
  return readGreyImage(path, header.width, header.height);
}

}  // namespace rf
