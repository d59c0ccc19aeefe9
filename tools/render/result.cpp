// SPDX-License-Identifier: BSD-3-Clause
#include "result.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>

#include "datasets/error.hpp"
#include "datasets/text.hpp"

namespace rf::render {
namespace {

constexpr std::int64_t kMarginUs = 10'000;  ///< of a trajectory that is cut to the time of another
constexpr std::int64_t kMaxGapUs =
    100'000;  ///< poses further apart in time are not the same moment

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> out(1);
  for (const char c : line) {
    if (c == ',') {
      out.emplace_back();
    } else if (c != '\r') {
      out.back() += c;
    }
  }
  return out;
}

std::size_t column(const std::vector<std::string>& names, const std::string& name,
                   const std::string& path) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) throw DatasetError(path + ": no column '" + name + "'");
  return static_cast<std::size_t>(found - names.begin());
}

const StampedPose* nearest(const Trajectory& poses, std::int64_t utime) {
  const auto closest =
      std::min_element(poses.begin(), poses.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.utime - utime) < std::abs(b.utime - utime);
      });
  if (closest == poses.end() || std::abs(closest->utime - utime) > kMaxGapUs) return nullptr;
  return &*closest;
}

/// A pose of each trajectory at the first time that both have.
struct Meeting {
  const SE3* a;
  const SE3* b;
};
std::optional<Meeting> firstMeeting(const Trajectory& a, const Trajectory& b) {
  for (const StampedPose& p : b) {
    if (const StampedPose* q = nearest(a, p.utime)) return Meeting{&q->pose, &p.pose};
  }
  return std::nullopt;
}

/// Cuts to the time that the estimate covers, so that a longer truth does not shrink the plot.
Trajectory within(const Trajectory& poses, const Trajectory& span) {
  if (span.empty()) return poses;
  Trajectory kept;
  for (const StampedPose& p : poses) {
    if (p.utime >= span.front().utime - kMarginUs && p.utime <= span.back().utime + kMarginUs) {
      kept.push_back(p);
    }
  }
  return kept;
}

std::vector<Vec3> pathOf(const Trajectory& poses, const SE3& T_RW, const Vec3& point) {
  std::vector<Vec3> path;
  path.reserve(poses.size());
  for (const StampedPose& p : poses) path.push_back(T_RW * (p.pose * point));
  return path;
}

/// From the source's world to the reference's, by the first camera pose that both have.
SE3 worldOffset(const Trajectory& reference, const Trajectory& source) {
  const auto meeting = firstMeeting(reference, source);
  return meeting ? *meeting->a * meeting->b->inverse() : SE3();
}

/// The point of the source's object frame that is the reference object's origin.
Vec3 originIn(const Trajectory& reference, const Trajectory& source, const SE3& T_RW,
              const Vec3& otherwise) {
  const auto meeting = firstMeeting(reference, source);
  return meeting ? (T_RW * *meeting->b).inverse() * meeting->a->t : otherwise;
}

}  // namespace

std::map<std::int64_t, FrameRow> readFrameRows(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  if (!file || !std::getline(file, line)) throw DatasetError(path + ": cannot be read or is empty");
  const std::vector<std::string> names = cells(line);
  const std::size_t utime = column(names, "utime", path);
  const std::size_t seq = column(names, "seq", path);
  const std::size_t health = column(names, "health", path);
  const std::size_t share = column(names, "dynamic_share", path);
  std::map<std::int64_t, FrameRow> rows;
  while (std::getline(file, line)) {
    const std::vector<std::string> row = cells(line);
    if (row.size() <= std::max({utime, seq, health, share})) continue;
    const auto time = parseDouble(row[utime]);
    const auto number = parseDouble(row[seq]);
    if (!time || !number || !std::isfinite(*time) || !std::isfinite(*number)) continue;
    const auto moving = parseDouble(row[share]);
    rows[std::llround(*time)] = {std::llround(*number), row[health], moving.value_or(0),
                                 moving.has_value()};
  }
  return rows;
}

Overlaid overlayTracks(const Tracks& truth, const Tracks& prior, const Tracks& estimate,
                       const std::optional<Vec3>& object_centre) {
  const Tracks& reference = truth.camera.empty() ? estimate : truth;
  const SE3 T_RP = worldOffset(reference.camera, prior.camera);
  const SE3 T_RE = worldOffset(reference.camera, estimate.camera);
  const Vec3 truth_point = Vec3::Zero();
  const Vec3 prior_point =
      originIn(truth.object, prior.object, T_RP, object_centre.value_or(Vec3::Zero()));
  const Vec3 estimate_point =
      originIn(truth.object, estimate.object, T_RE, object_centre.value_or(Vec3::Zero()));
  const bool object_is_placed =
      object_centre.has_value() || !truth.object.empty() || !prior.object.empty();
  const auto cut = [&](const Trajectory& t) { return within(t, estimate.camera); };
  Overlaid out;
  out.plane = groundPlane(skyAxis(reference.camera));
  out.series = {
      {"camera, truth", kBlack, false, 3.5, pathOf(cut(truth.camera), SE3(), Vec3::Zero())},
      {"camera, prior", kOrange, true, 2, pathOf(cut(prior.camera), T_RP, Vec3::Zero())},
      {"camera, estimated", kBlue, false, 2, pathOf(estimate.camera, T_RE, Vec3::Zero())},
      {"object, truth", kGrey, false, 3.5, pathOf(cut(truth.object), SE3(), truth_point)},
      {"object, prior", Colour(160, 120, 240), true, 2,
       pathOf(cut(prior.object), T_RP, prior_point)},
      {"object, estimated", kRed, false, 2,
       object_is_placed ? pathOf(estimate.object, T_RE, estimate_point) : std::vector<Vec3>()},
  };
  return out;
}

}  // namespace rf::render
