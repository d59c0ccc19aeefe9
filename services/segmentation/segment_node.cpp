// SPDX-License-Identifier: BSD-3-Clause
#include "segment_node.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rf {
namespace {

constexpr std::size_t kMaxPending = 64;

}  // namespace

SegmentNode::SegmentNode(Service& service, const SegmentationConfig& config,
                         const SegmentOptions& options, bool lockstep)
    : service_(service),
      config_(config),
      lockstep_(lockstep),
      prior_wait_(options.prior_wait_ms > 0 ? options.prior_wait_ms : (lockstep ? 2000 : 50)),
      state_wait_(options.state_wait_ms > 0 ? options.state_wait_ms : 4000),
      frames_(service.listen(Side::kBulk, options.frame_channel, lockstep ? 32 : 2)),
      cameras_(service.listen(Side::kState, "RF_CAMERA", 4)),
      prior_box_(service.listen(Side::kState, "RF_MOTION_PRIOR", 256)),
      states_(service.listen(Side::kState, "RF_MODEL_STATE", 16)) {}

bool SegmentNode::step() {
  takeMessages();
  for (const Command& command : service_.commands()) {
    if (command.kind == CommandKind::kReset) restart();
  }
  if (!stage_ || pending_.empty()) return false;
  const auto prior = priorFor(pending_.front());
  if (!prior || !feedbackReady(pending_.front())) return false;
  const Pending pending = std::move(pending_.front());
  pending_.pop_front();
  process(pending, *prior);
  return !pending_.empty();
}

void SegmentNode::takeMessages() {
  while (auto info = service_.take<rigidfusion::camera_t>(cameras_)) takeCamera(info->first);
  while (auto prior = service_.take<rigidfusion::motion_prior_t>(prior_box_))
    priors_.add(prior->first);
  while (auto state = service_.take<rigidfusion::model_state_t>(states_))
    state_ = std::move(state->first);
  while (auto frame = service_.take<bot_core::images_t>(frames_)) {
    takeFrame(std::move(frame->first), frame->second);
  }
}

void SegmentNode::takeCamera(const CameraInfo& info) {
  if (camera_ == info.camera) return;
  if (camera_) service_.warn("the calibration changed: starting anew");
  camera_ = info.camera;
  stage_ = std::make_unique<SegmentationStage>(config_, *camera_);
  restart();
}

void SegmentNode::restart() {
  if (stage_) stage_->reset();
  order_.reset();
  state_.reset();
  last_result_.clear();
}

void SegmentNode::takeFrame(EncodedFrame frame, Clock::time_point arrival) {
  switch (order_.judge(frame.utime, frame.seq)) {
    case FrameKind::kRepeated:
      if (!last_result_.empty()) service_.send(Side::kState, "RF_SEGMENTATION", last_result_);
      service_.monitor().resent();
      return;
    case FrameKind::kOld:
      return;
    case FrameKind::kRestart:
      service_.warn(
          fmt::format("time went back to {}: the stream began anew, so do we", frame.utime));
      restart();
      pending_.clear();
      break;
    case FrameKind::kNew:
      break;
  }
  const auto same = [&](const Pending& p) { return p.frame.utime == frame.utime; };
  if (std::any_of(pending_.begin(), pending_.end(), same)) return;
  service_.monitor().input();
  if (!lockstep_ || pending_.size() >= kMaxPending) {
    const std::size_t keep = lockstep_ ? kMaxPending - 1 : 0;
    service_.monitor().dropped(
        static_cast<std::int64_t>(pending_.size() - std::min(keep, pending_.size())));
    while (pending_.size() > keep) pending_.pop_front();
  }
  pending_.push_back({std::move(frame), arrival});
}

std::optional<MotionPrior> SegmentNode::priorFor(const Pending& pending) {
  const std::int64_t utime = pending.frame.utime;
  const std::int64_t utime_a = order_.lastUtime().value_or(utime);
  prior_missed_ = false;
  if (auto prior = priors_.find(utime_a, utime)) {
    prior->seq = pending.frame.seq >= 0 ? pending.frame.seq : count_;
    return prior;
  }
  if (!order_.lastUtime()) {  // our first frame need not be the stream's: any prior that ends here
                              // serves
    if (const auto link = priors_.endingAt(utime)) return firstFramePrior(*link);
  }
  if (Clock::now() - pending.arrival < prior_wait_) return std::nullopt;
  prior_missed_ = true;
  service_.warn(fmt::format("frame {}: no motion prior within {} ms; going on without",
                            pending.frame.seq, prior_wait_.count()));
  service_.monitor().lost(1);
  service_.setState(ServiceState::kDegraded, "no motion prior");
  return missingPrior(utime_a, utime, std::max<std::int64_t>(pending.frame.seq, 0));
}

bool SegmentNode::feedbackReady(const Pending& pending) const {
  if (!lockstep_ || !order_.lastUtime()) return true;
  if (state_ && state_->utime >= *order_.lastUtime()) return true;
  if (Clock::now() - pending.arrival < state_wait_) return false;
  service_.warn(
      fmt::format("frame {}: no model state of the frame before within {} ms; going on without",
                  pending.frame.seq, state_wait_.count()));
  return true;
}

void SegmentNode::process(const Pending& pending, const MotionPrior& prior) {
  const auto start = Clock::now();
  auto frame = decode(pending.frame);
  if (!frame) {
    service_.badInput("OPENNI_FRAME: " + frame.error);
    return;
  }
  if (frame->seq < 0) frame->seq = count_;
  SegmentationResult result;
  try {
    result = stage_->process(*frame, prior, state_ ? &*state_ : nullptr);
    last_result_ = pack(result);
  } catch (const std::invalid_argument& e) {
    service_.badInput(fmt::format("frame {}: {}", frame->seq, e.what()));
    return;
  }
  count_ = frame->seq + 1;
  service_.monitor().lost(order_.accept(frame->utime, frame->seq));
  priors_.forgetBefore(frame->utime);
  const auto end = Clock::now();
  if (!service_.send(Side::kState, "RF_SEGMENTATION", last_result_)) return;
  service_.monitor().output(result.seq, milliseconds(end - start),
                            milliseconds(end - pending.arrival), result.stage_ms);
  if (!prior_missed_) service_.setState(ServiceState::kRunning, "running");
}

}  // namespace rf
