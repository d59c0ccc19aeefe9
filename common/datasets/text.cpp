// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "datasets/error.hpp"

namespace rf {
namespace {

constexpr std::size_t kMaxTextBytes = std::size_t{256} << 20;
constexpr double kMaxSeconds = 1e12;

bool allDigits(std::string_view s) {
  return std::all_of(s.begin(), s.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::vector<std::string> splitWords(const std::string& line) {
  std::vector<std::string> words;
  constexpr const char* kBlank = " \t\r,";
  for (std::size_t begin = line.find_first_not_of(kBlank); begin != std::string::npos;) {
    const std::size_t end = line.find_first_of(kBlank, begin);
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kBlank, end);
  }
  return words;
}

/// Exact parse of digits[.digits]; nothing when the text has another form.
std::optional<std::int64_t> parsePlainDecimal(std::string_view s) {
  const bool negative = !s.empty() && s.front() == '-';
  if (negative || (!s.empty() && s.front() == '+')) s.remove_prefix(1);
  const std::size_t dot = s.find('.');
  const std::string_view whole = s.substr(0, dot);
  const std::string_view fraction = dot == s.npos ? std::string_view() : s.substr(dot + 1);
  if (whole.size() + fraction.size() == 0 || whole.size() > 12) return std::nullopt;
  if (!allDigits(whole) || !allDigits(fraction)) return std::nullopt;
  std::int64_t micros = 0;
  for (const char c : whole) micros = 10 * micros + (c - '0');
  for (std::size_t i = 0; i < 6; ++i) {
    micros = 10 * micros + (i < fraction.size() ? fraction[i] - '0' : 0);
  }
  if (fraction.size() > 6 && fraction[6] >= '5') ++micros;
  return negative ? -micros : micros;
}

}  // namespace

std::vector<TextLine> readTextLines(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw DatasetError(path + ": cannot be opened for reading");
  std::vector<TextLine> lines;
  std::size_t bytes = 0;
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    bytes += line.size() + 1;
    if (bytes > kMaxTextBytes) throw DatasetError(path + ": larger than 256 MiB");
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    lines.push_back({number, splitWords(line)});
  }
  if (file.bad()) throw DatasetError(path + ": cannot be read");
  return lines;
}

void refuse(const std::string& path, const TextLine& line, const std::string& rule) {
  throw DatasetError(fmt::format("{}:{}: {}", path, line.number, rule));
}

std::optional<double> parseDouble(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0;
  const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || stop != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parseTimestamp(std::string_view seconds) {
  if (const auto exact = parsePlainDecimal(seconds)) return exact;
  const std::optional<double> value = parseDouble(seconds);
  if (!value || !std::isfinite(*value) || std::abs(*value) > kMaxSeconds) return std::nullopt;
  return std::llround(*value * 1e6);
}

std::string formatTimestamp(std::int64_t utime) {
  const char* sign = utime < 0 ? "-" : "";
  const std::uint64_t magnitude =
      utime < 0 ? 0 - static_cast<std::uint64_t>(utime) : static_cast<std::uint64_t>(utime);
  return fmt::format("{}{}.{:06}", sign, magnitude / 1000000, magnitude % 1000000);
}

}  // namespace rf
