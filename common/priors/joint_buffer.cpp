// SPDX-License-Identifier: BSD-3-Clause
#include "priors/joint_buffer.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rf {
namespace {

constexpr double kJumpSlack = 0.05;  // rad or m: stamps jitter
constexpr std::size_t kNamesInText = 8;

/// The angle of the same direction that is nearest to `near`.
double unwound(double angle, double near) {
  constexpr double kTurn = 2 * std::numbers::pi;
  return angle + kTurn * std::round((near - angle) / kTurn);
}

template <class Names>
std::string listed(const Names& names) {
  std::vector<std::string> first;
  for (const auto& name : names) {
    if (first.size() == kNamesInText) break;
    first.push_back(name);
  }
  return fmt::format("{}{}", fmt::join(first, ", "), names.size() > first.size() ? ", ..." : "");
}

}  // namespace

JointBuffer::JointBuffer(const std::map<std::string, JointKind>& wanted, double max_speed,
                         double offset_s, std::size_t capacity)
    : max_speed_(max_speed), offset_us_(std::llround(1e6 * offset_s)), capacity_(capacity) {
  for (const auto& [name, kind] : wanted) tracks_[name].kind = kind;
}

void JointBuffer::allowAnySpeed(std::span<const std::string> joints) {
  for (const std::string& joint : joints) tracks_.at(joint).any_speed = true;
}

void JointBuffer::reserve(std::size_t capacity) { capacity_ = std::max(capacity_, capacity); }

std::string JointBuffer::add(std::int64_t utime, std::span<const std::string> names,
                             std::span<const double> positions) {
  if (names.size() != positions.size()) {
    ++counts_.refused;
    return fmt::format("it has {} names and {} positions", names.size(), positions.size());
  }
  std::string said;
  bool any = false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto track = tracks_.find(names[i]);
    if (track == tracks_.end()) continue;
    any = true;
    const std::string more =
        addOne(names[i], track->second, shiftedTime(utime, offset_us_), positions[i]);
    if (said.empty()) said = more;
  }
  if (any || tracks_.empty()) return said;
  ++counts_.refused;
  std::vector<std::string> wanted;
  for (const auto& [name, track] : tracks_) wanted.push_back(name);
  return fmt::format("it has none of the joints {}; it has {}", listed(wanted),
                     names.empty() ? "none at all" : listed(names));
}

std::string JointBuffer::addOne(const std::string& name, Track& track, std::int64_t utime,
                                double position) {
  if (!std::isfinite(position)) {
    ++counts_.refused;
    return fmt::format("joint '{}' is {}, must be finite", name, position);
  }
  std::string said;
  switch (track.timeline.judge(utime)) {
    case Timeline::Verdict::kLater:
      break;
    case Timeline::Verdict::kNotLater:
      ++counts_.refused;
      return fmt::format("joint '{}': it is not later than the sample before", name);
    case Timeline::Verdict::kAbsurd:
      ++counts_.refused;
      return "its time is absurd";
    case Timeline::Verdict::kRestarted:
      ++counts_.restarts;
      said = fmt::format("joint '{}': time went back, it begins anew", name);
      track.samples.clear();
      track.breaks.clear();
  }
  if (!track.samples.empty()) {
    const Sample& last = track.samples.back();
    if (track.kind == JointKind::kContinuous) position = unwound(position, last.position);
    const double dt = secondsBetween(last.utime, utime);
    const double moved = std::abs(position - last.position);
    if (!track.any_speed && moved > max_speed_ * dt + kJumpSlack) {
      said = fmt::format("joint '{}' jumps by {:.3f} in {:.3f} s (max_joint_speed is {} per s)",
                         name, moved, dt, max_speed_);
      ++counts_.jumps;
      track.breaks.add(last.utime, utime, said);
    }
  }
  if (track.samples.size() == capacity_) track.samples.pop_front();
  track.samples.push_back({utime, position});
  ++counts_.accepted;
  return said;
}

JointBuffer::PositionAt JointBuffer::lookUp(const Track& track, std::int64_t utime,
                                            double max_gap_s, double max_extrapolation_s) {
  const auto& samples = track.samples;
  if (samples.empty()) return {PriorState::kMissing, 0, "no position received"};
  const auto after = std::lower_bound(samples.begin(), samples.end(), utime,
                                      [](const Sample& s, std::int64_t t) { return s.utime < t; });
  if (after != samples.end() && after->utime == utime)
    return {PriorState::kValid, after->position, {}};
  const auto between = [&](const Sample& a, const Sample& b) {
    const double s = secondsBetween(a.utime, utime) / secondsBetween(a.utime, b.utime);
    return a.position + s * (b.position - a.position);
  };
  const bool late = after == samples.end();
  if (!late && after != samples.begin()) {
    const Sample& before = *std::prev(after);
    const double gap = secondsBetween(before.utime, after->utime);
    if (gap <= max_gap_s) return {PriorState::kValid, between(before, *after), {}};
    return {PriorState::kMissing, 0,
            fmt::format("gap of {:.3f} s between samples (limit {} s)", gap, max_gap_s)};
  }
  const double distance = late ? secondsBetween(samples.back().utime, utime)
                               : secondsBetween(utime, samples.front().utime);
  std::string where = fmt::format("{:.3f} s {}", distance,
                                  late ? "after the newest sample" : "before the oldest sample");
  if (track.timeline.refusedInARow() > 0) {
    where += fmt::format(" ({} since came with a time that does not advance)",
                         track.timeline.refusedInARow());
  }
  if (distance > max_extrapolation_s) {
    return {PriorState::kMissing, 0, fmt::format("{} (limit {} s)", where, max_extrapolation_s)};
  }
  if (samples.size() < 2) return {PriorState::kMissing, 0, where + ", velocity unknown"};
  const Sample& a = late ? samples[samples.size() - 2] : samples[0];
  const Sample& b = late ? samples[samples.size() - 1] : samples[1];
  if (secondsBetween(a.utime, b.utime) > max_gap_s)
    return {PriorState::kMissing, 0, where + ", velocity unknown across a gap"};
  return {PriorState::kExtrapolated, between(a, b), where};
}

JointsAt JointBuffer::at(std::int64_t utime, std::span<const std::string> joints, double max_gap_s,
                         double max_extrapolation_s) const {
  JointsAt out;
  out.state = PriorState::kValid;
  for (const std::string& joint : joints) {
    const PositionAt found = lookUp(tracks_.at(joint), utime, max_gap_s, max_extrapolation_s);
    if (found.state == PriorState::kMissing)
      return {PriorState::kMissing, {}, fmt::format("joint '{}': {}", joint, found.reason)};
    if (found.state == PriorState::kExtrapolated) {
      out.state = PriorState::kExtrapolated;
      out.reason = fmt::format("joint '{}': {}", joint, found.reason);
    }
    out.q[joint] = found.position;
  }
  return out;
}

std::string JointBuffer::flaw(std::int64_t a, std::int64_t b,
                              std::span<const std::string> joints) const {
  for (const std::string& joint : joints) {
    const Track& track = tracks_.at(joint);
    if (track.samples.empty()) continue;
    std::string why =
        track.breaks.within(a, b, track.samples.front().utime, track.samples.back().utime);
    if (!why.empty()) return why;
  }
  return {};
}

bool JointBuffer::covers(std::int64_t utime, std::span<const std::string> joints) const {
  return std::all_of(joints.begin(), joints.end(), [&](const std::string& joint) {
    const auto& samples = tracks_.at(joint).samples;
    return !samples.empty() && samples.back().utime >= utime;
  });
}

std::vector<std::string> JointBuffer::unseen() const {
  std::vector<std::string> out;
  for (const auto& [name, track] : tracks_) {
    if (track.samples.empty()) out.push_back(name);
  }
  return out;
}

}  // namespace rf
