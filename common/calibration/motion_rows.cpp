// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/motion_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "calibration/row_parts.hpp"

namespace rf::calibration {
namespace {

constexpr double kTimeMargin = 0.1;       ///< s that the offset may still move
constexpr double kFrozenFor = 0.15;       ///< s of one pose, to the bit, while X moves
constexpr double kMovedDistance = 0.015;  ///< m
constexpr double kMovedAngle = 0.015;     ///< rad
constexpr double kFewestBlocks = 6;       ///< of which two are held out

enum class Fate : std::uint8_t { kGood, kNotCovered, kFrozen, kJump };

bool moved(const SE3& d) {
  return d.t.norm() > kMovedDistance || d.log().tail<3>().norm() > kMovedAngle;
}

/// Longest time within from..to over which the path repeats one pose.
double longestStandstill(const Path& path, double from, double to) {
  const std::vector<double>& times = path.times();
  double longest = 0;
  double since = 0;
  auto i = static_cast<std::size_t>(
      std::distance(times.begin(), std::lower_bound(times.begin(), times.end(), from)));
  since = i < times.size() ? times[i] : to;
  for (; i + 1 < times.size() && times[i] < to; ++i) {
    if (path.poses()[i] == path.poses()[i + 1]) {
      longest = std::max(longest, times[i + 1] - since);
    } else {
      since = times[i + 1];
    }
  }
  return longest;
}

bool jumps(const Path& path, double from, double to, const RowOptions& options) {
  const std::vector<double>& times = path.times();
  auto i = static_cast<std::size_t>(
      std::distance(times.begin(), std::upper_bound(times.begin(), times.end(), from)));
  for (i = i > 0 ? i - 1 : 0; i + 1 < times.size() && times[i] < to; ++i) {
    const double dt = times[i + 1] - times[i];
    const SE3 d = path.poses()[i].inverse() * path.poses()[i + 1];
    // Very short steps magnify the noise of a single pose.
    const double window = std::max(dt, 0.02);
    if (d.t.norm() > options.max_speed * window) return true;
    if (d.log().tail<3>().norm() > options.max_turn * window) return true;
  }
  return false;
}

Fate judge(const Path& A, const Path& X, double from, double to, double offset,
           const RowOptions& options) {
  const double a_from = from - offset - kTimeMargin;
  const double a_to = to - offset + kTimeMargin;
  if (a_from < A.begin() || a_to > A.end()) return Fate::kNotCovered;
  if (A.longestGap(a_from, a_to) > options.max_gap) return Fate::kNotCovered;
  if (jumps(A, from - offset, to - offset, options) || jumps(X, from, to, options)) {
    return Fate::kJump;
  }
  const double still = longestStandstill(A, from - offset, to - offset);
  if (still > kFrozenFor && moved(X.at(from).inverse() * X.at(to))) return Fate::kFrozen;
  return Fate::kGood;
}

void count(Fate fate, DroppedRows* dropped) {
  if (fate == Fate::kNotCovered) ++dropped->not_covered;
  if (fate == Fate::kFrozen) ++dropped->frozen;
  if (fate == Fate::kJump) ++dropped->jumps;
}

/// Indices of X's poses that are about `interval` apart.
std::vector<std::size_t> spaced(const Path& X, double interval) {
  std::vector<std::size_t> nodes{0};
  const std::vector<double>& times = X.times();
  for (std::size_t i = 1; i < times.size(); ++i) {
    if (times[i] - times[nodes.back()] >= interval - 1e-3) nodes.push_back(i);
  }
  return nodes;
}

bool heldOut(double time, const Path& X, double block) {
  const double length = std::min(block, (X.end() - X.begin()) / kFewestBlocks);
  return static_cast<std::int64_t>(std::floor((time - X.begin()) / length)) % 3 == 1;
}

}  // namespace

MotionRows motionRows(const Path& A, const Path& X, double offset, const RowOptions& options) {
  MotionRows out;
  const std::vector<std::size_t> nodes = spaced(X, options.interval);
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    const double from = X.times()[nodes[k - 1]];
    const double to = X.times()[nodes[k]];
    const Fate fate = to - from > 2 * options.interval + options.max_gap
                          ? Fate::kNotCovered
                          : judge(A, X, from, to, offset, options);
    count(fate, &out.dropped);
    if (fate != Fate::kGood) continue;
    const MotionRow row{from, to, X.poses()[nodes[k - 1]].inverse() * X.poses()[nodes[k]]};
    auto& rows = heldOut(from, X, options.block) ? out.held_out : out.fit;
    rows.push_back(row);
  }
  return out;
}

PoseRows poseRows(const Path& A, const Path& X, double offset, const RowOptions& options) {
  PoseRows out;
  const std::vector<std::size_t> nodes = spaced(X, options.interval);
  for (std::size_t k = 1; k < nodes.size(); ++k) {
    const double from = X.times()[nodes[k - 1]];
    const double to = X.times()[nodes[k]];
    // Frozen and jump are judged on the way from the pose before.
    const Fate fate = judge(A, X, std::max(from, to - 2 * options.interval), to, offset, options);
    count(fate, &out.dropped);
    if (fate != Fate::kGood) continue;
    auto& rows = heldOut(to, X, options.block) ? out.held_out : out.fit;
    rows.push_back({to, X.poses()[nodes[k]]});
  }
  return out;
}

std::vector<MotionRow> joined(const std::vector<MotionRow>& rows, double baseline) {
  std::vector<MotionRow> out;
  for (std::size_t i = 0; i < rows.size();) {
    MotionRow sum = rows[i++];
    while (i < rows.size() && sum.to - sum.from < baseline - 1e-3 &&
           std::abs(rows[i].from - sum.to) < kSameTime) {
      sum.d_X = sum.d_X * rows[i].d_X;
      sum.to = rows[i++].to;
    }
    if (sum.to - sum.from >= 0.8 * baseline) out.push_back(sum);
  }
  return out;
}

}  // namespace rf::calibration
