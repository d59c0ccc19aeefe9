// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rf {

/// One line of a TUM text file: words between blanks; commas count as blanks.
struct TextLine {
  std::size_t number = 0;  ///< from 1
  std::vector<std::string> words;
};

/// All lines that are neither empty nor comments (#). Throws DatasetError when the file cannot be
/// read or is larger than 256 MiB.
std::vector<TextLine> readTextLines(const std::string& path);

/// Throws DatasetError "PATH:LINE: rule".
[[noreturn]] void refuse(const std::string& path, const TextLine& line, const std::string& rule);

/// The whole word as a number, or nothing. NaN and infinities are numbers here.
std::optional<double> parseDouble(std::string_view word);

/// Decimal seconds as microseconds, exact for plain decimals (rounded to the nearest microsecond);
/// exponents are accepted with the precision of a double. Nothing when it is no finite number or
/// beyond +-1e12 s.
std::optional<std::int64_t> parseTimestamp(std::string_view seconds);

/// Microseconds as decimal seconds with six decimals, as in file names and trajectories.
std::string formatTimestamp(std::int64_t utime);

}  // namespace rf
