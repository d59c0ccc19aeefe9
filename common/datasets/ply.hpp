// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "values/surfel_point.hpp"

namespace rf {

/// Writes surfels as binary little-endian PLY with the properties
/// x y z red green blue nx ny nz radius confidence (float, three uchar, float). The file appears
/// under its name only when it is complete. Throws DatasetError.
void writePly(const std::string& path, const std::vector<SurfelPoint>& points);

/// Reads the vertices of an ascii or binary little-endian PLY; x y z are required, the other
/// properties stay 0 when absent, unknown scalar properties and further elements are skipped.
/// Throws DatasetError naming file and rule for damaged or truncated files, and for points that
/// are not finite; allocation is bounded by the file's size.
std::vector<SurfelPoint> readPly(const std::string& path);

}  // namespace rf
