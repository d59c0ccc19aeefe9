// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/camera.hpp"
#include "messaging/wire.hpp"
#include "pipeline/codec.hpp"
#include "values/model_state.hpp"
#include "values/motion_prior.hpp"
#include "values/segmentation_result.hpp"
#include "values/stamped_pose.hpp"
#include "values/surfel_point.hpp"

namespace rf {

// Free functions between the stages' values and the messages. Each direction checks what passes:
// numbers are finite, quaternions have unit length, enums are known, sizes agree; a failure names
// the member, its value and the rule. A value that passes comes back equal to the bit.

/// Health, poses and covariances of one frame's result for one body, as RF_POSE_* carries it.
struct StampedBodyPose {
  std::int64_t utime = 0;
  std::int64_t seq = 0;
  BodyPose pose;
};

/// Calibration with the words that say where it comes from.
struct CameraInfo {
  std::int64_t utime = 0;
  std::string source;
  Camera camera;
};

enum class TickState : std::int8_t { kPublished = 1, kLost = 2, kEnd = 3 };

/// Capture's word on one frame: frame_tick_t.
struct FrameTick {
  std::int64_t utime = 0;
  std::int64_t colour_utime = 0;
  std::int64_t seq = 0;
  TickState state = TickState::kPublished;
  std::string reason;
  bool operator==(const FrameTick&) const = default;
};

/// A part of a body's surfels: model_chunk_t.
struct ModelChunk {
  std::int64_t utime = 0;
  std::int64_t request_id = 0;
  std::uint8_t body = kBodyStatic;
  int chunk = 0;
  int n_chunks = 1;
  std::int64_t total_surfels = 0;
  std::vector<SurfelPoint> surfels;
};

/// Surfels in a chunk, so that it stays below 60 KB.
inline constexpr int kSurfelsPerChunk = 1700;

enum class CommandKind : std::int8_t {
  kReset = 1,
  kSave = 2,
  kStop = 3,
  kSendModel = 4,
  kResendChunks = 5
};

struct Command {
  std::int64_t utime = 0;
  std::int64_t id = 0;
  std::string target;
  CommandKind kind = CommandKind::kSave;
  std::string argument;
  std::uint8_t body = 0;
  std::vector<int> chunks;
};

Result<bot_core::images_t> toMessage(const EncodedFrame& frame);
Result<rigidfusion::body_pose_t> toMessage(const StampedBodyPose& pose);
Result<rigidfusion::camera_t> toMessage(const CameraInfo& info);
Result<rigidfusion::command_t> toMessage(const Command& command);
Result<rigidfusion::frame_tick_t> toMessage(const FrameTick& tick);
Result<rigidfusion::model_chunk_t> toMessage(const ModelChunk& chunk);
Result<rigidfusion::model_state_t> toMessage(const ModelState& state);
Result<rigidfusion::motion_prior_t> toMessage(const MotionPrior& prior);
Result<rigidfusion::segmentation_t> toMessage(const SegmentationResult& result);
/// A pose as existing LCM robots read it; velocities and accelerations are 0.
Result<bot_core::pose_t> toBotPose(const StampedPose& pose);

/// Accepts what openni2-camera-lcm sends too: colour as JPEG, RGB or BGR under type LEFT, depth
/// under DEPTH_MM or DEPTH_MM_ZIPPED with whatever pixelformat; seq is -1 where the sender does not
/// count. Row padding is refused by the size check of decode.
Result<EncodedFrame> toValue(const bot_core::images_t& message);
Result<StampedBodyPose> toValue(const rigidfusion::body_pose_t& message);
Result<CameraInfo> toValue(const rigidfusion::camera_t& message);
Result<Command> toValue(const rigidfusion::command_t& message);
Result<FrameTick> toValue(const rigidfusion::frame_tick_t& message);
Result<ModelChunk> toValue(const rigidfusion::model_chunk_t& message);
Result<ModelState> toValue(const rigidfusion::model_state_t& message);
Result<MotionPrior> toValue(const rigidfusion::motion_prior_t& message);
Result<SegmentationResult> toValue(const rigidfusion::segmentation_t& message);
/// Normalises the quaternion, which foreign senders give in varying precision (length within 1 %).
Result<StampedPose> toValue(const bot_core::pose_t& message);

/// Bytes of a message straight to a value.
template <class Message>
auto unpack(ByteView bytes) -> decltype(toValue(std::declval<Message>())) {
  auto message = decodeMessage<Message>(bytes);
  using Out = decltype(toValue(std::declval<Message>()));
  if (!message) return Out::failure(message.error);
  return toValue(*message);
}

/// A value straight to bytes; throws std::invalid_argument with the reason when it must not be
/// sent.
template <class Value>
Bytes pack(const Value& value) {
  auto message = toMessage(value);
  if (!message) throw std::invalid_argument(message.error);
  return encodeMessage(*message);
}

}  // namespace rf
