// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/covariance_table.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "datasets/error.hpp"
#include "datasets/text.hpp"

namespace rf {
namespace {

constexpr int kDimension = 6;
constexpr std::size_t kFirstValue = 3;  // after timestamp, body, health
constexpr std::size_t kWords = kFirstValue + 21;
constexpr std::array<Health, 5> kStates = {Health::kInvalid, Health::kTracked, Health::kDegraded,
                                           Health::kPriorOnly, Health::kLost};

std::string header() {
  std::string row = "timestamp,body,health";
  for (int r = 0; r < kDimension; ++r) {
    for (int c = r; c < kDimension; ++c) row += fmt::format(",c{}{}", r, c);
  }
  return row;
}

std::string rowOf(std::int64_t utime, const char* body, const BodyPose& pose) {
  std::string row = fmt::format("{},{},{}", formatTimestamp(utime), body, name(pose.health));
  for (int r = 0; r < kDimension; ++r) {
    for (int c = r; c < kDimension; ++c) row += fmt::format(",{:.6e}", pose.covariance(r, c));
  }
  return row;
}

Health parseHealth(const std::string& path, const TextLine& line, const std::string& word) {
  for (const Health h : kStates) {
    if (word == name(h)) return h;
  }
  refuse(path, line,
         fmt::format("health = {}: must be tracked, degraded, prior-only or lost", word));
}

Mat6 parseMatrix(const std::string& path, const TextLine& line) {
  Mat6 m;
  std::size_t at = kFirstValue;
  for (int r = 0; r < kDimension; ++r) {
    for (int c = r; c < kDimension; ++c, ++at) {
      const std::optional<double> value = parseDouble(line.words[at]);
      if (!value || !std::isfinite(*value)) {
        refuse(path, line,
               fmt::format("c{}{} = {}: must be a finite number", r, c, line.words[at]));
      }
      m(r, c) = m(c, r) = *value;
    }
  }
  return m;
}

PoseCovariance parseRow(const std::string& path, const TextLine& line) {
  const std::optional<std::int64_t> utime = parseTimestamp(line.words[0]);
  if (!utime) refuse(path, line, fmt::format("timestamp = {}: must be seconds", line.words[0]));
  return {*utime, parseHealth(path, line, line.words[2]), parseMatrix(path, line)};
}

}  // namespace

CovarianceTable::CovarianceTable(const std::string& path)
    : path_(path), file_(path, std::ios::trunc) {
  if (!file_) throw DatasetError(path + ": cannot be opened for writing");
  write(header());
}

void CovarianceTable::write(const std::string& row) {
  file_ << row << '\n' << std::flush;
  if (!file_) throw DatasetError(path_ + ": cannot be written");
}

void CovarianceTable::add(const ModelState& state) {
  write(rowOf(state.utime, "camera", state.camera));
  if (state.object_exists) write(rowOf(state.utime, "object", state.object));
}

CovarianceFile readCovariances(const std::string& path) {
  CovarianceFile file;
  for (const TextLine& line : readTextLines(path)) {
    if (line.words.front() == "timestamp") continue;
    if (line.words.size() != kWords) {
      refuse(path, line, fmt::format("{} columns: must be {}", line.words.size(), kWords));
    }
    const std::string& body = line.words[1];
    if (body != "camera" && body != "object") {
      refuse(path, line, fmt::format("body = {}: must be camera or object", body));
    }
    PoseCovariances& rows = body == "camera" ? file.camera : file.object;
    const PoseCovariance row = parseRow(path, line);
    if (!rows.empty() && row.utime <= rows.back().utime) {
      refuse(path, line,
             fmt::format("timestamp = {}: must be later than the row before", line.words[0]));
    }
    rows.push_back(row);
  }
  return file;
}

}  // namespace rf
