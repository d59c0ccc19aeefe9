// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "geometry/se3.hpp"

namespace rf {

/// Seconds with six decimals.
std::string stampText(std::int64_t utime);

/// One line of a TUM trajectory: timestamp tx ty tz qx qy qz qw.
std::string tumLine(std::int64_t utime, const SE3& T);

/// Writes a whole file. Throws std::runtime_error that names it.
void writeText(const std::filesystem::path& file, const std::string& text);

}  // namespace rf
