// SPDX-License-Identifier: BSD-3-Clause
#include "fuse_node.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "config/yaml.hpp"
#include "datasets/error.hpp"
#include "datasets/ply.hpp"

namespace rf {
namespace {

constexpr std::size_t kMaxUnanswered = 100000;
constexpr int kChunksPerStep = 4;  ///< 240 KB at most between two looks at the mailboxes

/// A command may name a folder inside the result folder, nothing elsewhere.
bool isPlainName(const std::string& name) {
  return !name.empty() && name.find('/') == std::string::npos && name != "." && name != "..";
}

}  // namespace

FuseNode::FuseNode(Service& service, const PipelineConfig& config, const FuseOptions& options,
                   bool lockstep)
    : service_(service),
      config_(config),
      options_(options),
      frame_wait_(options.frame_wait_ms > 0 ? options.frame_wait_ms : (lockstep ? 10000 : 200)),
      frames_box_(service.listen(Side::kBulk, options.frame_channel, 32)),
      cameras_(service.listen(Side::kState, "RF_CAMERA", 4)),
      segmentations_box_(service.listen(Side::kState, "RF_SEGMENTATION", 64)),
      ticks_(service.listen(Side::kState, "RF_FRAME_TICK", 1024)),
      max_frames_(lockstep ? 64 : 16) {}

bool FuseNode::step() {
  takeMessages();
  for (const Command& command : service_.commands()) obey(command);
  sendChunks();
  if (!stage_ || segmentations_.empty()) return !chunks_.empty();
  const auto it = frames_.find(segmentations_.front().segmentation.utime);
  if (it == frames_.end()) {
    if (Clock::now() - segmentations_.front().arrival >= frame_wait_) skipWithoutFrame();
    return false;
  }
  const Waiting waiting = std::move(segmentations_.front());
  segmentations_.pop_front();
  auto frame = decode(it->second);
  frames_.erase(frames_.begin(), std::next(it));
  if (!frame) {
    service_.badInput("OPENNI_FRAME: " + frame.error);
    skipped_ =
        skipped_ ? composeSegmentations(*skipped_, waiting.segmentation) : waiting.segmentation;
    return true;
  }
  frame->seq = waiting.segmentation.seq;
  fuse(*frame, waiting);
  return !segmentations_.empty();
}

void FuseNode::takeMessages() {
  while (auto info = service_.take<rigidfusion::camera_t>(cameras_)) takeCamera(info->first);
  while (auto tick = service_.take<rigidfusion::frame_tick_t>(ticks_)) takeTick(tick->first);
  while (auto frame = service_.take<bot_core::images_t>(frames_box_))
    takeFrame(std::move(frame->first));
  while (auto s = service_.take<rigidfusion::segmentation_t>(segmentations_box_)) {
    takeSegmentation(std::move(s->first), s->second);
  }
}

void FuseNode::takeCamera(const CameraInfo& info) {
  if (camera_ == info.camera) return;
  if (camera_) service_.warn("the calibration changed: starting anew");
  camera_ = info.camera;
  stage_ = std::make_unique<FusionStage>(config_.fusion, *camera_);
  restart();
  if (!options_.output.empty() && !writer_) {
    writer_ = std::make_unique<ResultWriter>(
        options_.output, *camera_,
        ResultWriter::Options{options_.write_masks, writeConfig(config_),
                              config_.fusion.object.false_birth_frames});
  }
}

void FuseNode::restart() {
  if (stage_) stage_->reset();
  order_.reset();
  skipped_.reset();
  last_state_.clear();
}

void FuseNode::takeFrame(EncodedFrame frame) {
  const auto last = order_.lastUtime();
  const bool repeated = (last && frame.utime == *last) || frames_.contains(frame.utime);
  if (repeated && !last_state_.empty()) {
    // The sender misses the newest state, or segmentation waits for it.
    service_.send(Side::kState, "RF_MODEL_STATE", last_state_);
    service_.monitor().resent();
  }
  if (repeated || order_.judge(frame.utime, frame.seq) == FrameKind::kOld) return;
  service_.monitor().input();
  const std::int64_t utime = frame.utime;
  frames_.insert_or_assign(utime, std::move(frame));
  while (frames_.size() > max_frames_) {
    frames_.erase(frames_.begin()->first == utime ? std::next(frames_.begin()) : frames_.begin());
    service_.monitor().dropped(1);
  }
}

void FuseNode::takeSegmentation(SegmentationResult segmentation, Clock::time_point arrival) {
  const auto same = [&](const Waiting& w) { return w.segmentation.utime == segmentation.utime; };
  if (std::any_of(segmentations_.begin(), segmentations_.end(), same)) return;
  const auto kind = order_.judge(segmentation.utime, segmentation.seq);
  if (kind == FrameKind::kRestart) {
    service_.warn(
        fmt::format("time went back to {}: the stream began anew, so do we", segmentation.utime));
    restart();
  } else if (kind != FrameKind::kNew) {
    return;
  }
  segmentations_.push_back({std::move(segmentation), arrival});
}

void FuseNode::takeTick(const FrameTick& tick) {
  if (tick.state == TickState::kLost) {
    if (tick.seq > order_.lastSeq() && lost_.size() < kMaxUnanswered) lost_[tick.seq] = tick;
  } else if (tick.state == TickState::kPublished && tick.seq > order_.lastSeq() &&
             unanswered_.size() < kMaxUnanswered) {
    unanswered_[tick.seq] = tick;
  }
}

void FuseNode::listLost() {
  for (const auto& [seq, tick] : lost_) {
    if (writer_) writer_->addLost(tick.utime, seq, tick.reason);
  }
  lost_.clear();
}

void FuseNode::skipWithoutFrame() {
  const SegmentationResult& s = segmentations_.front().segmentation;
  service_.warn(
      fmt::format("frame {}: its image did not arrive within {} ms; its motion goes to the next",
                  s.seq, frame_wait_.count()));
  service_.monitor().lost(1);
  service_.setState(ServiceState::kDegraded, "images are lost");
  skipped_ = skipped_ ? composeSegmentations(*skipped_, s) : s;
  segmentations_.pop_front();
}

void FuseNode::fuse(const RgbdFrame& frame, const Waiting& waiting) {
  const auto start = Clock::now();
  SegmentationResult segmentation =
      skipped_ ? composeSegmentations(*skipped_, waiting.segmentation) : waiting.segmentation;
  skipped_.reset();
  bool whole = true;
  if (const auto last = order_.lastUtime();
      last && !segmentation.first && segmentation.utime_a != *last) {
    service_.warn(fmt::format("frame {}: the motion since {} is unknown, a segmentation was lost",
                              frame.seq, *last));
    segmentation.camera.health = std::max(segmentation.camera.health, Health::kDegraded);
    service_.setState(ServiceState::kDegraded, "segmentations are lost");
    whole = false;
  }
  listLost();
  try {
    const ModelState state = stage_->process(frame, segmentation);
    last_state_ = pack(state);
    if (writer_) writer_->add(frame, segmentation, state);
    service_.monitor().lost(order_.accept(frame.utime, frame.seq));
    last_utime_ = frame.utime;
    publish(state);
    const auto end = Clock::now();
    service_.monitor().output(frame.seq, milliseconds(end - start),
                              milliseconds(end - waiting.arrival), state.stage_ms);
  } catch (const std::invalid_argument& e) {
    service_.badInput(fmt::format("frame {}: {}", frame.seq, e.what()));
    return;
  }
  unanswered_.erase(frame.seq);
  if (whole) service_.setState(ServiceState::kRunning, "running");
}

void FuseNode::publish(const ModelState& state) {
  service_.send(Side::kState, "RF_MODEL_STATE", last_state_);
  service_.send(Side::kState, "RF_POSE_CAMERA",
                pack(StampedBodyPose{state.utime, state.seq, state.camera}));
  const auto bot = [&](const std::string& channel, const SE3& pose) {
    const auto message = toBotPose({state.utime, pose});
    if (!channel.empty() && message) service_.send(Side::kState, channel, encodeMessage(*message));
  };
  bot(options_.camera_pose_channel, state.camera.T_W);
  if (!state.object_exists) return;
  service_.send(Side::kState, "RF_POSE_OBJECT",
                pack(StampedBodyPose{state.utime, state.seq, state.object}));
  bot(options_.object_pose_channel, state.object.T_W);
}

void FuseNode::obey(const Command& command) {
  switch (command.kind) {
    case CommandKind::kReset:
      restart();
      break;
    case CommandKind::kSave:
      writeModels(command.argument);
      break;
    case CommandKind::kSendModel:
    case CommandKind::kResendChunks:
      queueModel(command);
      break;
    case CommandKind::kStop:
      break;
  }
}

void FuseNode::queueModel(const Command& command) {
  if (!stage_) return;
  if (command.kind == CommandKind::kSendModel) model_ = stage_->surfels(command.body);
  const int n =
      std::max(1, static_cast<int>((model_.size() + kSurfelsPerChunk - 1) / kSurfelsPerChunk));
  const auto queueOne = [&](int i) {
    if (i < 0 || i >= n) return;
    ModelChunk chunk{
        last_utime_, command.id, command.body == kBodyObject ? kBodyObject : kBodyStatic,
        i,           n,          static_cast<std::int64_t>(model_.size()),
        {}};
    const auto from = static_cast<std::size_t>(i) * kSurfelsPerChunk;
    const auto to = std::min(model_.size(), from + kSurfelsPerChunk);
    chunk.surfels.assign(model_.begin() + static_cast<std::ptrdiff_t>(from),
                         model_.begin() + static_cast<std::ptrdiff_t>(to));
    chunks_.push_back(std::move(chunk));
  };
  if (command.kind == CommandKind::kResendChunks) {
    for (const int i : command.chunks) queueOne(i);
    return;
  }
  chunks_.clear();
  for (int i = 0; i < n; ++i) queueOne(i);
}

void FuseNode::sendChunks() {
  for (int i = 0; i < kChunksPerStep && !chunks_.empty(); ++i) {
    service_.send(Side::kBulk, "RF_MODEL", pack(chunks_.front()));
    chunks_.pop_front();
  }
}

void FuseNode::writeModels(const std::string& folder_name) {
  if (!stage_ || !writer_) {
    service_.warn("nothing to save: no --output, or no camera yet");
    return;
  }
  const auto static_surfels = stage_->surfels(kBodyStatic);
  const auto object_surfels = stage_->surfels(kBodyObject);
  if (folder_name.empty()) {
    writer_->writeModels(static_surfels, object_surfels);
  } else if (isPlainName(folder_name)) {
    const auto folder = std::filesystem::path(options_.output) / folder_name;
    std::filesystem::create_directories(folder);
    writePly((folder / "static.ply").string(), static_surfels);
    writePly((folder / "object.ply").string(), object_surfels);
  } else {
    service_.warn("SAVE: folder '" + folder_name +
                  "': must be a plain name inside the result folder");
    return;
  }
  service_.info(fmt::format("saved {} static and {} object surfels", static_surfels.size(),
                            object_surfels.size()));
}

void FuseNode::finish() {
  if (!writer_) return;
  listLost();
  for (const auto& [seq, tick] : unanswered_) writer_->addLost(tick.utime, seq, "no result");
  unanswered_.clear();
  writeModels("");
}

}  // namespace rf
