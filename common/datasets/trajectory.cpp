// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/trajectory.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "datasets/error.hpp"
#include "datasets/text.hpp"

namespace rf {
namespace {

SE3 parsePose(const std::string& path, const TextLine& line) {
  static constexpr std::array<const char*, 7> kNames = {"tx", "ty", "tz", "qx", "qy", "qz", "qw"};
  std::array<double, 7> values{};
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string& word = line.words[i + 1];
    const std::optional<double> value = parseDouble(word);
    if (!value) refuse(path, line, fmt::format("{} = {}: must be a number", kNames[i], word));
    if (!std::isfinite(*value)) {
      refuse(path, line, fmt::format("{} = {}: must be finite", kNames[i], word));
    }
    values[i] = *value;
  }
  const Eigen::Quaterniond q(values[6], values[3], values[4], values[5]);
  const double norm = q.norm();
  if (!(std::abs(norm - 1.0) <= kUnitQuaternionTolerance)) {
    refuse(
        path, line,
        fmt::format("quaternion length = {}: must be 1 within {}", norm, kUnitQuaternionTolerance));
  }
  return {q.normalized(), Vec3(values[0], values[1], values[2])};
}

double withoutNegativeZero(double x) { return std::abs(x) < 0.5e-9 ? 0.0 : x; }

}  // namespace

Trajectory readTrajectory(const std::string& path) {
  Trajectory trajectory;
  for (const TextLine& line : readTextLines(path)) {
    if (line.words.size() < 8) {
      refuse(path, line,
             fmt::format("{} words: must be timestamp tx ty tz qx qy qz qw", line.words.size()));
    }
    const std::optional<std::int64_t> utime = parseTimestamp(line.words[0]);
    if (!utime) {
      refuse(path, line, fmt::format("timestamp = {}: must be seconds", line.words[0]));
    }
    const SE3 pose = parsePose(path, line);
    if (!trajectory.empty() && *utime <= trajectory.back().utime) {
      refuse(path, line,
             fmt::format("timestamp = {}: must be later than {} of the line before", line.words[0],
                         formatTimestamp(trajectory.back().utime)));
    }
    trajectory.push_back({*utime, pose});
  }
  return trajectory;
}

std::string formatTumPose(std::int64_t utime, const SE3& pose) {
  std::string line = formatTimestamp(utime);
  for (const double x :
       {pose.t.x(), pose.t.y(), pose.t.z(), pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w()}) {
    line += fmt::format(" {:.9f}", withoutNegativeZero(x));
  }
  return line;
}

TrajectoryWriter::TrajectoryWriter(const std::string& path, const std::string& comment)
    : path_(path), file_(path, std::ios::trunc) {
  if (!file_) throw DatasetError(path + ": cannot be opened for writing");
  file_ << "# " << comment << '\n' << std::flush;
}

void TrajectoryWriter::add(std::int64_t utime, const SE3& pose) {
  if (!pose.isFinite()) {
    throw DatasetError(path_ + ": pose at " + formatTimestamp(utime) + ": must be finite");
  }
  file_ << formatTumPose(utime, pose) << '\n' << std::flush;
  if (!file_) throw DatasetError(path_ + ": cannot be written");
}

}  // namespace rf
