// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "geometry/image.hpp"

namespace rf {

/// Files <timestamp>.png of a folder by utime; empty when the folder is not there.
std::map<std::int64_t, std::string> listMasks(const std::string& folder);

/// One mask, 8 bits a pixel. Throws DatasetError naming the file.
Image<std::uint8_t> readMask(const std::string& path);

}  // namespace rf
