// SPDX-License-Identifier: BSD-3-Clause
#include "prior_node.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rf {
namespace {

constexpr std::size_t kMemory = 64;

const char* reason(PoseVerdict verdict) {
  switch (verdict) {
    case PoseVerdict::kNotFinite:
      return "it is not finite";
    case PoseVerdict::kNotUnit:
      return "its quaternion is not of unit length";
    case PoseVerdict::kNotLater:
      return "it is not later than the pose before";
    case PoseVerdict::kAccepted:
      break;
  }
  return "";
}

}  // namespace

PriorNode::PriorNode(Service& service, PriorStage stage, const PriorOptions& options)
    : service_(service),
      stage_(std::move(stage)),
      options_(options),
      live_(!options.camera_channel.empty() || !options.object_channel.empty() ||
            options.robot_live),
      ticks_(service.listen(Side::kState, "RF_FRAME_TICK", 1024)) {
  if (!options.camera_channel.empty()) {
    camera_poses_ = service.listen(Side::kState, options.camera_channel, 4096);
    stage_.expectCamera();
  }
  if (!options.object_channel.empty()) {
    object_poses_ = service.listen(Side::kState, options.object_channel, 4096);
    stage_.expectObject();
  }
  if (options.robot_live && stage_.robot() != nullptr) robot_feed_.emplace(service, options.robot);
}

bool PriorNode::step() {
  takePoses();
  if (robot_feed_) robot_feed_->take(*stage_.robot());
  while (auto tick = service_.take<rigidfusion::frame_tick_t>(ticks_))
    takeTick(tick->first, tick->second);
  for (const Command& command : service_.commands()) {
    if (command.kind == CommandKind::kReset) {
      stage_.restart();
      order_.reset();
      answered_.clear();
    }
  }
  if (waiting_.empty()) return false;
  const bool worth_waiting =
      live_ && !stage_.covers(waiting_.front().tick.utime) &&
      Clock::now() - waiting_.front().arrival < std::chrono::milliseconds(options_.wait_ms);
  if (worth_waiting) return false;
  const Waiting waiting = waiting_.front();
  waiting_.pop_front();
  answer(waiting);
  return !waiting_.empty();
}

void PriorNode::takePoses() {
  if (!options_.camera_channel.empty()) {
    while (auto pose = service_.take<bot_core::pose_t>(camera_poses_)) {
      takePose("camera", options_.camera_channel, pose->first,
               stage_.addCameraPose(pose->first.utime, pose->first.pose));
    }
  }
  if (!options_.object_channel.empty()) {
    while (auto pose = service_.take<bot_core::pose_t>(object_poses_)) {
      takePose("object", options_.object_channel, pose->first,
               stage_.addObjectPose(pose->first.utime, pose->first.pose));
    }
  }
}

void PriorNode::takePose(const char* source, const std::string& channel, const StampedPose& pose,
                         PoseVerdict verdict) {
  if (verdict == PoseVerdict::kAccepted) return;
  service_.badInput(
      fmt::format("{}: {} pose at {}: {}", channel, source, pose.utime, reason(verdict)));
}

void PriorNode::takeTick(const FrameTick& tick, Clock::time_point arrival) {
  if (tick.state != TickState::kPublished) return;
  if (const auto known = answered_.find(tick.utime); known != answered_.end()) {
    service_.send(Side::kState, "RF_MOTION_PRIOR", known->second);
    service_.monitor().resent();
    if (tick.seq != 0 || order_.lastSeq() <= 0) return;
  }
  const auto same = [&](const Waiting& w) { return w.tick.utime == tick.utime; };
  if (std::any_of(waiting_.begin(), waiting_.end(), same)) return;
  const auto kind = order_.judge(tick.utime, tick.seq);
  if (kind == FrameKind::kOld || kind == FrameKind::kRepeated) return;
  if (kind == FrameKind::kRestart) {
    service_.warn(fmt::format("time went back to {}: the stream began anew, so do we", tick.utime));
    stage_.restart();
    order_.reset();
    answered_.clear();
  }
  service_.monitor().input();
  service_.monitor().lost(order_.accept(tick.utime, tick.seq));
  waiting_.push_back({tick, arrival});
}

void PriorNode::answer(const Waiting& waiting) {
  const auto start = Clock::now();
  const MotionPrior prior = stage_.process(waiting.tick.utime, waiting.tick.seq);
  const Bytes bytes = pack(prior);
  answered_[waiting.tick.utime] = bytes;
  if (answered_.size() > kMemory) answered_.erase(answered_.begin());
  service_.send(Side::kState, "RF_MOTION_PRIOR", bytes);
  const auto end = Clock::now();
  service_.monitor().output(prior.seq, milliseconds(end - start),
                            milliseconds(end - waiting.arrival));
  const auto& status = stage_.status();
  const bool missing = !status.camera_reason.empty() || !status.object_reason.empty();
  if (missing) {
    service_.warn(
        fmt::format("frame {}: {} {}", prior.seq,
                    status.camera_reason.empty() ? "" : "camera prior: " + status.camera_reason,
                    status.object_reason.empty() ? "" : "object prior: " + status.object_reason));
  }
  service_.setState(missing ? ServiceState::kDegraded : ServiceState::kRunning,
                    missing ? "priors are missing or extrapolated" : "running");
}

}  // namespace rf
