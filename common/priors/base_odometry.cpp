// SPDX-License-Identifier: BSD-3-Clause
#include "priors/base_odometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rf {
namespace {

constexpr double kJumpSlackM = 0.02;  // stamps jitter: a step this small is no jump at any speed
constexpr double kJumpSlackRad = 0.02;
constexpr double kUnchanged = 1e-9;  // metres, radians
constexpr std::int64_t kJoinUs = 1000;
constexpr std::size_t kMarks = 100000;

SE3 scaled(const SE3& step, double metres, double radians) {
  if (metres == 1 && radians == 1) return step;
  Vec6 xi = step.log();
  xi.head<3>() *= metres;
  xi.tail<3>() *= radians;
  return SE3::exp(xi);
}

std::string poseProblem(const SE3& pose) {
  if (!pose.isFinite()) return "it is not finite";
  if (std::abs(pose.q.norm() - 1.0) > kUnitQuaternionTolerance)
    return fmt::format("its quaternion has length {:.3g}, must be 1", pose.q.norm());
  return {};
}

}  // namespace

BaseOdometry::BaseOdometry(const RobotConfig& config, double max_gap_s)
    : config_(config), max_gap_s_(max_gap_s) {}

std::int64_t BaseOdometry::shifted(std::int64_t utime) const {
  return shiftedTime(utime, std::llround(1e6 * config_.odometry_offset));
}

std::string BaseOdometry::refuse(std::string why) {
  ++counts_.refused;
  return why;
}

void BaseOdometry::forget() {
  const SourceCounts kept = counts_;
  poses_.clear();
  breaks_.clear();
  marks_.clear();
  last_raw_.reset();
  last_.reset();
  last_twist_.reset();
  counts_ = kept;
}

bool BaseOdometry::takeTime(std::int64_t utime, std::string& said) {
  switch (timeline_.judge(utime)) {
    case Timeline::Verdict::kLater:
      return true;
    case Timeline::Verdict::kNotLater:
      said = refuse("it is not later than the sample before");
      return false;
    case Timeline::Verdict::kAbsurd:
      said = refuse("its time is absurd");
      return false;
    case Timeline::Verdict::kRestarted:
      break;
  }
  ++counts_.restarts;
  said = "time went back: the odometry begins anew";
  forget();
  return true;
}

/// Appends the pose that follows the last by `step`; `joined`: nothing is missing between.
std::string BaseOdometry::push(std::int64_t utime, const SE3& step, StatedSpeed stated,
                               bool joined) {
  std::string said;
  Mark mark{utime, utime, stated};
  StampedPose next{utime, step};
  if (last_) {
    const double dt = secondsBetween(last_->utime, utime);
    const double metres = step.t.norm();
    const double radians = step.log().tail<3>().norm();
    if (!joined) {
      said = fmt::format("odometry has a hole of {:.3f} s", dt);
    } else if (metres > config_.max_speed * dt + kJumpSlackM) {
      said = fmt::format("odometry jumps by {:.3f} m in {:.3f} s (max_speed is {} m/s)", metres, dt,
                         config_.max_speed);
    } else if (radians > config_.max_turn * dt + kJumpSlackRad) {
      said = fmt::format("odometry jumps by {:.3f} rad in {:.3f} s (max_turn is {} rad/s)", radians,
                         dt, config_.max_turn);
    }
    if (!said.empty()) {
      ++counts_.jumps;
      breaks_.add(last_->utime, utime, said);
    }
    if (metres < kUnchanged && radians < kUnchanged && !marks_.empty())
      mark.unchanged_since = marks_.back().unchanged_since;
    next.pose = last_->pose * step;
  }
  poses_.add(utime, next.pose);
  if (marks_.size() == kMarks) marks_.pop_front();
  marks_.push_back(mark);
  last_ = next;
  ++counts_.accepted;
  return said;
}

std::string BaseOdometry::addPose(std::int64_t utime, const SE3& T_WB,
                                  std::optional<StatedSpeed> stated) {
  if (std::string why = poseProblem(T_WB); !why.empty()) return refuse(std::move(why));
  const std::int64_t at = shifted(utime);
  std::string said;
  if (!takeTime(at, said)) return said;
  const SE3 pose(T_WB.q.normalized(), T_WB.t);
  SE3 step = pose;
  if (last_raw_)
    step = scaled(last_raw_->pose.inverse() * pose, config_.wheel_scale, config_.turn_scale);
  last_raw_ = StampedPose{at, pose};
  const std::string more = push(at, step, stated.value_or(StatedSpeed{}), true);
  return said.empty() ? more : said;
}

std::string BaseOdometry::addTwist(std::int64_t utime, const PlanarTwist& twist) {
  if (!std::isfinite(twist.vx + twist.vy + twist.wz)) return refuse("it is not finite");
  if (const double speed = std::hypot(twist.vx, twist.vy); speed > config_.max_speed)
    return refuse(
        fmt::format("its speed is {:.3g} m/s, max_speed is {}", speed, config_.max_speed));
  if (std::abs(twist.wz) > config_.max_turn)
    return refuse(
        fmt::format("it turns at {:.3g} rad/s, max_turn is {}", twist.wz, config_.max_turn));
  const std::int64_t at = shifted(utime);
  std::string said;
  if (!takeTime(at, said)) return said;
  SE3 step;
  bool joined = true;
  if (last_ && last_twist_) {
    const double dt = secondsBetween(last_->utime, at);
    joined = dt <= max_gap_s_;
    const PlanarTwist mean{0.5 * (last_twist_->vx + twist.vx) * config_.wheel_scale,
                           0.5 * (last_twist_->vy + twist.vy) * config_.wheel_scale,
                           0.5 * (last_twist_->wz + twist.wz) * config_.turn_scale};
    if (joined) step = arc(mean, dt);
  }
  last_twist_ = twist;
  const std::string more = push(at, step, {}, joined);
  return said.empty() ? more : said;
}

std::string BaseOdometry::addIncrement(std::int64_t from_utime, std::int64_t utime,
                                       const SE3& T_prev_now) {
  if (std::string why = poseProblem(T_prev_now); !why.empty()) return refuse(std::move(why));
  const std::int64_t from = shifted(from_utime);
  const std::int64_t at = shifted(utime);
  if (from >= at) return refuse("it ends before it begins");
  std::string said;
  if (!takeTime(at, said)) return said;
  if (!last_) {
    push(from, SE3(), {}, true);
  }
  const bool joined = from - last_->utime <= kJoinUs && last_->utime - from <= kJoinUs;
  const SE3 step(T_prev_now.q.normalized(), T_prev_now.t);
  const std::string more =
      push(at, scaled(step, config_.wheel_scale, config_.turn_scale), {}, joined);
  return said.empty() ? more : said;
}

PoseAt BaseOdometry::at(std::int64_t utime, double max_gap_s, double max_extrapolation_s) const {
  PoseAt found = poses_.at(utime, max_gap_s, max_extrapolation_s);
  if (found.state != PriorState::kValid && timeline_.refusedInARow() > 0) {
    found.reason += fmt::format(" ({} samples since came with a time that does not advance)",
                                timeline_.refusedInARow());
  }
  return found;
}

const BaseOdometry::Mark* BaseOdometry::markAt(std::int64_t utime) const {
  const auto after = std::upper_bound(marks_.begin(), marks_.end(), utime,
                                      [](std::int64_t t, const Mark& m) { return t < m.utime; });
  return after == marks_.begin() ? nullptr : &*std::prev(after);
}

std::vector<std::int64_t> BaseOdometry::times() const {
  std::vector<std::int64_t> out;
  out.reserve(marks_.size());
  for (const Mark& mark : marks_) out.push_back(mark.utime);
  return out;
}

std::optional<double> BaseOdometry::stillFor(std::int64_t a, std::int64_t b) const {
  const Mark* mark = markAt(b);
  if (mark == nullptr || mark->unchanged_since > a || mark->unchanged_since == mark->utime)
    return std::nullopt;
  return secondsBetween(mark->unchanged_since, mark->utime);
}

std::string BaseOdometry::flaw(std::int64_t a, std::int64_t b) const {
  if (poses_.empty()) return {};
  if (std::string why = breaks_.within(a, b, poses_.oldest(), poses_.newest()); !why.empty())
    return why;
  const std::optional<double> still = stillFor(a, b);
  if (!still || *still < config_.frozen_after) return {};
  const StatedSpeed stated = markAt(b)->stated;
  if (stated.speed > config_.frozen_speed) {
    return fmt::format("odometry stands still for {:.3f} s although it reports {:.3f} m/s", *still,
                       stated.speed);
  }
  if (stated.turn > config_.frozen_speed) {
    return fmt::format("odometry stands still for {:.3f} s although it reports {:.3f} rad/s",
                       *still, stated.turn);
  }
  return {};
}

}  // namespace rf
