// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/per_frame.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>

#include <fmt/format.h>

namespace rf {
namespace {

constexpr std::int64_t kSameMomentUs = 20000;
constexpr std::int64_t kUsPerSecond = 1'000'000;

/// Index of the pose nearest to a time; nothing when it is more than 20 ms away.
std::optional<std::size_t> nearest(const Trajectory& poses, std::int64_t utime) {
  std::optional<std::size_t> best;
  std::int64_t best_difference = kSameMomentUs + 1;
  auto p = std::lower_bound(poses.begin(), poses.end(), utime - kSameMomentUs,
                            [](const StampedPose& pose, std::int64_t t) { return pose.utime < t; });
  for (; p != poses.end() && p->utime <= utime + kSameMomentUs; ++p) {
    const std::int64_t difference = std::abs(p->utime - utime);
    if (difference >= best_difference) continue;
    best_difference = difference;
    best = static_cast<std::size_t>(p - poses.begin());
  }
  return best;
}

std::map<std::int64_t, double> errorsByTime(const AlignedTrajectory& body) {
  std::map<std::int64_t, double> errors;
  for (const PosePair& p : matchPoses(body.estimate, body.truth, kSameMomentUs)) {
    errors[p.utime] = (p.truth.t - (body.left * p.estimate * body.right).t).norm();
  }
  return errors;
}

std::optional<double> find(const std::map<std::int64_t, double>& values, std::int64_t utime) {
  const auto at = values.find(utime);
  return at == values.end() ? std::nullopt : std::optional(at->second);
}

std::string cell(const std::optional<double>& value) {
  return value ? fmt::format(",{:.6f}", *value) : std::string(",");
}

std::string cells(const std::optional<PixelCounts>& pixels) {
  if (!pixels) return ",,,,,,,";
  const PixelCounts& p = *pixels;
  return fmt::format(",{:.6f},{:.6f},{:.6f},{},{},{},{}", p.iou(), p.staticAccuracy(),
                     p.dynamicAccuracy(), p.static_right, p.static_wrong, p.dynamic_right,
                     p.dynamic_wrong);
}

}  // namespace

std::vector<double> displacementsSinceRest(const Trajectory& truth, double rest_speed) {
  const std::vector<double> speed = speeds(truth);
  std::vector<double> displacements(truth.size(), 0.0);
  std::size_t rest = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (speed[i] < rest_speed) rest = i;
    displacements[i] = (truth[i].pose.t - truth[rest].pose.t).norm();
  }
  return displacements;
}

std::vector<FrameScore> scoreFrames(const std::vector<std::int64_t>& frames,
                                    const AlignedTrajectory& camera,
                                    const AlignedTrajectory& object, double rest_speed) {
  const std::map<std::int64_t, double> camera_errors = errorsByTime(camera);
  const std::map<std::int64_t, double> object_errors = errorsByTime(object);
  const std::vector<double> speed = speeds(object.truth);
  const std::vector<double> displacement = displacementsSinceRest(object.truth, rest_speed);
  std::vector<FrameScore> scores;
  scores.reserve(frames.size());
  for (const std::int64_t utime : frames) {
    FrameScore s;
    s.utime = utime;
    s.camera_error = find(camera_errors, utime);
    s.object_error = find(object_errors, utime);
    if (const auto at = nearest(object.truth, utime)) {
      s.object_speed = speed[*at];
      s.object_displacement = displacement[*at];
    }
    scores.push_back(s);
  }
  return scores;
}

double dynamicShare(const Image<std::uint8_t>& truth) {
  const auto known = std::count_if(truth.begin(), truth.end(), [](auto v) { return v != 0; });
  const auto dynamic = std::count_if(truth.begin(), truth.end(), [](auto v) { return v == 2; });
  return known == 0 ? 0.0 : static_cast<double>(dynamic) / static_cast<double>(known);
}

std::string toCsv(const std::vector<FrameScore>& frames) {
  std::string text =
      "timestamp,object_speed_m_per_s,object_displacement_m,dynamic_share,camera_error_m,"
      "object_error_m,iou,static_accuracy,dynamic_accuracy,static_right,static_wrong,"
      "dynamic_right,dynamic_wrong\n";
  for (const FrameScore& f : frames) {
    text += fmt::format("{}.{:06}", f.utime / kUsPerSecond, f.utime % kUsPerSecond);
    text += cell(f.object_speed) + cell(f.object_displacement) + cell(f.dynamic_share) +
            cell(f.camera_error) + cell(f.object_error) + cells(f.pixels) + "\n";
  }
  return text;
}

}  // namespace rf
