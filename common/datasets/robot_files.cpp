// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/robot_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <set>

#include "datasets/error.hpp"
#include "datasets/text.hpp"
#include "datasets/trajectory.hpp"

namespace rf {
namespace {

constexpr std::size_t kMaxJoints = 1000;

double finite(const std::string& path, const TextLine& line, const std::string& column,
              const std::string& word) {
  const std::optional<double> value = parseDouble(word);
  if (!value) refuse(path, line, fmt::format("{} = {}: must be a number", column, word));
  if (!std::isfinite(*value)) {
    refuse(path, line, fmt::format("{} = {}: must be finite", column, word));
  }
  return *value;
}

/// A table of numbers under a header whose first column is the time.
struct Table {
  std::vector<std::string> columns;  ///< without the time
  struct Row {
    TextLine line;
    std::int64_t utime = 0;
    std::vector<double> values;
  };
  std::vector<Row> rows;
};

std::vector<std::string> readHeader(const std::string& path, const TextLine& line) {
  if (line.words.front() != "timestamp") {
    refuse(path, line, fmt::format("header begins with {}: must be timestamp", line.words.front()));
  }
  if (line.words.size() > kMaxJoints + 1) {
    refuse(path, line,
           fmt::format("{} columns: at most {} are allowed", line.words.size(), kMaxJoints + 1));
  }
  std::set<std::string> seen;
  for (const std::string& word : line.words) {
    if (!seen.insert(word).second) refuse(path, line, fmt::format("column {} comes twice", word));
  }
  return {line.words.begin() + 1, line.words.end()};
}

Table readTable(const std::string& path) {
  Table table;
  bool first = true;
  for (const TextLine& line : readTextLines(path)) {
    if (line.words.empty()) continue;
    if (first) {
      table.columns = readHeader(path, line);
      first = false;
      continue;
    }
    if (line.words.size() != table.columns.size() + 1) {
      refuse(path, line,
             fmt::format("{} columns: must be {} as in the header", line.words.size(),
                         table.columns.size() + 1));
    }
    Table::Row row{line, 0, {}};
    const std::optional<std::int64_t> utime = parseTimestamp(line.words[0]);
    if (!utime) refuse(path, line, fmt::format("timestamp = {}: must be seconds", line.words[0]));
    row.utime = *utime;
    if (!table.rows.empty() && row.utime <= table.rows.back().utime) {
      refuse(path, line,
             fmt::format("timestamp = {}: must be later than {} of the row before", line.words[0],
                         formatTimestamp(table.rows.back().utime)));
    }
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      row.values.push_back(finite(path, line, table.columns[i], line.words[i + 1]));
    table.rows.push_back(std::move(row));
  }
  if (first) throw DatasetError(path + ": has no header");
  return table;
}

Table readTable(const std::string& path, const std::vector<std::string>& columns) {
  Table table = readTable(path);
  if (table.columns != columns) {
    throw DatasetError(fmt::format("{}: header is timestamp,{}: must be timestamp,{}", path,
                                   fmt::join(table.columns, ","), fmt::join(columns, ",")));
  }
  return table;
}

SE3 heldPose(const std::string& path, const TextLine& line, const std::vector<double>& v) {
  const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
  if (!(std::abs(q.norm() - 1) <= kUnitQuaternionTolerance)) {
    refuse(path, line,
           fmt::format("quaternion length = {}: must be 1 within {}", q.norm(),
                       kUnitQuaternionTolerance));
  }
  return {q.normalized(), Vec3(v[1], v[2], v[3])};
}

}  // namespace

JointTable readJoints(const std::string& path) {
  Table table = readTable(path);
  if (table.columns.empty()) throw DatasetError(path + ": header names no joint");
  JointTable out{std::move(table.columns), {}};
  for (Table::Row& row : table.rows) out.rows.push_back({row.utime, std::move(row.values)});
  return out;
}

std::vector<StampedTwist> readTwists(const std::string& path) {
  std::vector<StampedTwist> out;
  for (const Table::Row& row : readTable(path, {"vx", "vy", "wz"}).rows)
    out.push_back({row.utime, {row.values[0], row.values[1], row.values[2]}});
  return out;
}

std::vector<Grasp> readGrasps(const std::string& path) {
  std::vector<Grasp> out;
  const Table table = readTable(path, {"held", "tx", "ty", "tz", "qx", "qy", "qz", "qw"});
  for (const Table::Row& row : table.rows) {
    if (row.values[0] != 0 && row.values[0] != 1)
      refuse(path, row.line, fmt::format("held = {}: must be 0 or 1", row.values[0]));
    const bool held = row.values[0] == 1;
    out.push_back({row.utime, held, held ? heldPose(path, row.line, row.values) : SE3()});
  }
  return out;
}

}  // namespace rf
