// SPDX-License-Identifier: BSD-3-Clause
#include "priors/grasp_timeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rf {
namespace {

constexpr double kAnewSeconds = 1.0;

bool sameGrasp(const Grasp& a, const Grasp& b) {
  return a.held == b.held && (!a.held || a.T_GO == b.T_GO);
}

}  // namespace

GraspTimeline::GraspTimeline(double offset_s) : offset_us_(std::llround(1e6 * offset_s)) {}

std::string GraspTimeline::add(const Grasp& grasp) {
  const auto refuse = [this](std::string why) {
    ++counts_.refused;
    return why;
  };
  if (grasp.utime > kAbsurdTime || grasp.utime < -kAbsurdTime) return refuse("its time is absurd");
  if (grasp.held && !grasp.T_GO.isFinite()) return refuse("T_GO is not finite");
  if (grasp.held && std::abs(grasp.T_GO.q.norm() - 1) > kUnitQuaternionTolerance)
    return refuse(
        fmt::format("T_GO's quaternion has length {:.3g}, must be 1", grasp.T_GO.q.norm()));
  Grasp event = grasp;
  event.utime += offset_us_;
  event.T_GO = grasp.held ? SE3(grasp.T_GO.q.normalized(), grasp.T_GO.t) : SE3();
  std::string said;
  if (!events_.empty() && event.utime <= newest_) {
    if (secondsBetween(event.utime, newest_) <= kAnewSeconds)
      return refuse("it is not later than the grasp before");
    while (!events_.empty() && events_.back().utime >= event.utime) events_.pop_back();
    ++counts_.restarts;
    said = "time went back: later grasps are forgotten";
  }
  newest_ = event.utime;
  ++counts_.accepted;
  if (!events_.empty() && sameGrasp(events_.back(), event)) return said;
  if (events_.size() == kMost) events_.pop_front();
  events_.push_back(event);
  return said;
}

GraspTimeline::Held GraspTimeline::between(std::int64_t a, std::int64_t b) const {
  const auto after = [this](std::int64_t utime) {
    return std::upper_bound(events_.begin(), events_.end(), utime,
                            [](std::int64_t t, const Grasp& g) { return t < g.utime; });
  };
  const auto end = after(b);
  if (end == events_.begin()) return {false, SE3(), "nothing was grasped yet"};
  const Grasp& now = *std::prev(end);
  if (!now.held) return {false, SE3(), "the object is not held"};
  if (after(a) != end) return {false, SE3(), "grasped between the two frames"};
  return {true, now.T_GO, {}};
}

}  // namespace rf
