// SPDX-License-Identifier: BSD-3-Clause
#include "record_node.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <optional>

namespace rf {
namespace {

constexpr auto kFlushGap = std::chrono::seconds(1);
constexpr int kBatch = 64;

template <class Message>
std::optional<std::int64_t> seqIn(const RawMessage& message) {
  const auto decoded = decodeMessage<Message>(message.bytes);
  if (!decoded) return std::nullopt;
  if constexpr (std::is_same_v<Message, bot_core::images_t>) {
    const auto frame = toValue(*decoded);
    return frame && frame->seq >= 0 ? std::optional(frame->seq) : std::nullopt;
  } else {
    return decoded->seq;
  }
}

/// The frame count that a message of ours carries.
std::optional<std::int64_t> frameSeq(const RawMessage& message) {
  if (message.channel == "OPENNI_FRAME") return seqIn<bot_core::images_t>(message);
  if (message.channel == "RF_FRAME_TICK") return seqIn<rigidfusion::frame_tick_t>(message);
  if (message.channel == "RF_MOTION_PRIOR") return seqIn<rigidfusion::motion_prior_t>(message);
  if (message.channel == "RF_SEGMENTATION") return seqIn<rigidfusion::segmentation_t>(message);
  if (message.channel == "RF_MODEL_STATE") return seqIn<rigidfusion::model_state_t>(message);
  return std::nullopt;
}

}  // namespace

RecordNode::RecordNode(Service& service, const RecordOptions& options, bool one_bus)
    : service_(service),
      options_(options),
      bulk_(service.listen(Side::kBulk, options.channels, one_bus ? 4096 : 512)),
      one_bus_(one_bus) {
  if (!one_bus_) state_ = service.listen(Side::kState, options.channels, 16384);
  open();
}

std::string RecordNode::fileName() const {
  if (options_.split_mb <= 0) return options_.output;
  const std::filesystem::path path(options_.output);
  return (path.parent_path() /
          fmt::format("{}.{:02}{}", path.stem().string(), file_index_, path.extension().string()))
      .string();
}

void RecordNode::open() {
  const auto folder = std::filesystem::path(options_.output).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  log_ = std::make_unique<LogWriter>(fileName());
}

bool RecordNode::step() {
  bool any = false;
  for (int i = 0; i < kBatch; ++i) {
    auto message = one_bus_ ? std::nullopt : service_.takeRaw(state_);
    if (!message) message = service_.takeRaw(bulk_);
    if (!message) break;
    write(*message);
    any = true;
  }
  service_.commands();
  const auto now = std::chrono::steady_clock::now();
  if (now - last_flush_ > kFlushGap) {
    log_->flush();
    last_flush_ = now;
  }
  return any;
}

void RecordNode::write(const RawMessage& message) {
  const auto start = std::chrono::steady_clock::now();
  service_.monitor().input();
  watchSequence(message);
  if (options_.split_mb > 0 && log_->bytes() > options_.split_mb * 1000000) {
    log_->flush();
    ++file_index_;
    open();
  }
  log_->write(wallUtime(), message.channel, message.bytes);
  const auto end = std::chrono::steady_clock::now();
  const auto ms = [&](auto from) {
    return std::chrono::duration<double, std::milli>(end - from).count();
  };
  service_.monitor().output(log_->events(), ms(start), ms(message.arrival));
  service_.setState(ServiceState::kRunning, "recording");
}

void RecordNode::watchSequence(const RawMessage& message) {
  const auto seq = frameSeq(message);
  if (!seq) return;
  const auto last = last_seq_.find(message.channel);
  if (last != last_seq_.end() && *seq > last->second + 1) {
    service_.monitor().lost(*seq - last->second - 1);
    service_.warn(fmt::format("{}: {} after {}: {} missing", message.channel, *seq, last->second,
                              *seq - last->second - 1));
  }
  last_seq_[message.channel] = *seq;
}

void RecordNode::finish() {
  while (step()) {
  }
  log_->flush();
  service_.info(fmt::format("{}: {} events, {:.1f} MB", fileName(), log_->events(),
                            static_cast<double>(log_->bytes()) / 1e6));
}

}  // namespace rf
