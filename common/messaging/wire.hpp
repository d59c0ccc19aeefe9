// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bot_core/images_t.hpp>
#include <bot_core/joint_state_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <bot_core/robot_state_t.hpp>
#include <bot_core/system_status_t.hpp>
#include <cstdint>
#include <exception>
#include <pronto/update_t.hpp>
#include <rigidfusion/body_pose_t.hpp>
#include <rigidfusion/camera_t.hpp>
#include <rigidfusion/command_t.hpp>
#include <rigidfusion/frame_tick_t.hpp>
#include <rigidfusion/grasp_t.hpp>
#include <rigidfusion/model_chunk_t.hpp>
#include <rigidfusion/model_state_t.hpp>
#include <rigidfusion/motion_prior_t.hpp>
#include <rigidfusion/planar_twist_t.hpp>
#include <rigidfusion/segmentation_t.hpp>
#include <rigidfusion/service_status_t.hpp>
#include <span>
#include <string>
#include <vector>

#include "values/result.hpp"

namespace rf {

using Bytes = std::vector<std::uint8_t>;
using ByteView = std::span<const std::uint8_t>;

/// Walks a message's bytes after the hash and says whether every count in it is non-negative and
/// fits into what is left, and whether nothing is left over. lcm-gen's decoders allocate by the
/// counts they read, so this runs first. Empty when all is well, else what is wrong. One overload
/// for each type that may be received; the argument is only a tag.
std::string layoutProblem(ByteView body, const bot_core::images_t*);
std::string layoutProblem(ByteView body, const bot_core::joint_state_t*);
std::string layoutProblem(ByteView body, const bot_core::pose_t*);
std::string layoutProblem(ByteView body, const bot_core::rigid_transform_t*);
std::string layoutProblem(ByteView body, const bot_core::robot_state_t*);
std::string layoutProblem(ByteView body, const bot_core::system_status_t*);
std::string layoutProblem(ByteView body, const pronto::update_t*);
std::string layoutProblem(ByteView body, const rigidfusion::body_pose_t*);
std::string layoutProblem(ByteView body, const rigidfusion::camera_t*);
std::string layoutProblem(ByteView body, const rigidfusion::command_t*);
std::string layoutProblem(ByteView body, const rigidfusion::frame_tick_t*);
std::string layoutProblem(ByteView body, const rigidfusion::grasp_t*);
std::string layoutProblem(ByteView body, const rigidfusion::model_chunk_t*);
std::string layoutProblem(ByteView body, const rigidfusion::model_state_t*);
std::string layoutProblem(ByteView body, const rigidfusion::motion_prior_t*);
std::string layoutProblem(ByteView body, const rigidfusion::planar_twist_t*);
std::string layoutProblem(ByteView body, const rigidfusion::segmentation_t*);
std::string layoutProblem(ByteView body, const rigidfusion::service_status_t*);

/// The first 8 bytes, big-endian; 0 when there are fewer.
std::uint64_t wireHash(ByteView bytes);
/// "not a camera_t: its hash is ..., not ..." for messages.
std::string hashProblem(const char* type, std::uint64_t found, std::uint64_t expected);

/// Decodes a message; fails on a foreign hash, counts that do not fit, or bytes left over.
template <class T>
Result<T> decodeMessage(ByteView bytes) {
  const auto hash = static_cast<std::uint64_t>(T::getHash());
  if (wireHash(bytes) != hash) {
    return Result<T>::failure(hashProblem(T::getTypeName(), wireHash(bytes), hash));
  }
  if (const auto problem = layoutProblem(bytes.subspan(8), static_cast<const T*>(nullptr));
      !problem.empty()) {
    return Result<T>::failure(std::string(T::getTypeName()) + ": " + problem);
  }
  T message;
  if (message.decode(bytes.data(), 0, static_cast<int>(bytes.size())) !=
      static_cast<int>(bytes.size())) {
    return Result<T>::failure(std::string(T::getTypeName()) + ": does not decode");
  }
  return message;
}

/// Encodes a message whose counts equal its vectors' sizes.
template <class T>
Bytes encodeMessage(const T& message) {
  Bytes bytes(static_cast<std::size_t>(message.getEncodedSize()));
  const int written = message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  bytes.resize(written < 0 ? 0 : static_cast<std::size_t>(written));
  return bytes;
}

}  // namespace rf
