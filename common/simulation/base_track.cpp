// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/base_track.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rf::sim {
namespace {

constexpr double kTrackStep = 0.001;  // seconds

}  // namespace

SE3 planarStep(const PlanarTwist& twist, double seconds) {
  Vec6 xi = Vec6::Zero();
  xi << twist.vx * seconds, twist.vy * seconds, 0, 0, 0, twist.wz * seconds;
  return SE3::exp(xi);
}

BaseTrack::BaseTrack(const SE3& start, Speeds speeds, double lateral_slip, double end)
    : speeds_(std::move(speeds)), lateral_slip_(lateral_slip) {
  poses_.push_back(start);
  const auto steps = static_cast<int>(std::ceil(end / kTrackStep));
  for (int i = 0; i < steps; ++i) {
    SE3 next = poses_.back() * planarStep(twistAt((i + 0.5) * kTrackStep), kTrackStep);
    next.q.normalize();
    poses_.push_back(next);
  }
}

PlanarTwist BaseTrack::twistAt(double t) const {
  const double vx = speeds_.vx.at(t);
  const double wz = speeds_.wz.at(t);
  return {vx, speeds_.vy.at(t) - lateral_slip_ * vx * wz, wz};
}

SE3 BaseTrack::poseAt(double t) const {
  if (t <= 0) return poses_.front();
  const double at = t / kTrackStep;
  const auto i = static_cast<std::size_t>(at);
  if (i + 1 >= poses_.size()) return poses_.back();
  return interpolate(poses_[i], poses_[i + 1], at - static_cast<double>(i));
}

}  // namespace rf::sim
