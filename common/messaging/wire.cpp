// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/wire.hpp"

#include <fmt/format.h>

namespace rf {
namespace {

/// Reads big-endian numbers and skips the rest; after the first fault every call does nothing.
class Cursor {
 public:
  explicit Cursor(ByteView bytes) : bytes_(bytes) {}

  void skip(std::size_t n) {
    if (!problem_.empty()) return;
    if (n > bytes_.size() - at_) {
      problem_ = fmt::format("truncated: {} bytes wanted at byte {}, {} are left", n, at_, left());
      return;
    }
    at_ += n;
  }
  std::size_t count32(const char* name) {
    return checked(name, static_cast<std::int32_t>(number(4)));
  }
  std::size_t count16(const char* name) {
    return checked(name, static_cast<std::int16_t>(number(2)));
  }
  /// n elements of `size` bytes.
  void array(std::size_t n, std::size_t size) {
    if (!problem_.empty()) return;
    if (n > left() / size) {
      problem_ = fmt::format("{} elements of {} bytes wanted, {} bytes are left", n, size, left());
      return;
    }
    at_ += n * size;
  }
  void string() {
    const auto length = count32("string length");
    if (!problem_.empty()) return;
    if (length == 0 || length > left()) {
      problem_ = fmt::format("string of {} bytes, {} are left", length, left());
    } else if (bytes_[at_ + length - 1] != 0) {
      problem_ = "string does not end in a zero byte";
    } else {
      at_ += length;
    }
  }
  /// n strings; each takes at least 5 bytes.
  void strings(std::size_t n) {
    if (problem_.empty() && n > left() / 5) problem_ = fmt::format("{} strings do not fit", n);
    for (std::size_t i = 0; i < n && problem_.empty(); ++i) string();
  }
  bool good() const { return problem_.empty(); }
  std::string finish() const {
    if (problem_.empty() && left() > 0) return fmt::format("{} bytes too many", left());
    return problem_;
  }
  void fail(std::string problem) {
    if (problem_.empty()) problem_ = std::move(problem);
  }
  std::size_t left() const { return bytes_.size() - at_; }

 private:
  std::uint32_t number(std::size_t bytes) {
    const auto start = at_;
    skip(bytes);
    if (!problem_.empty()) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value = value << 8U | bytes_[start + i];
    return value;
  }
  std::size_t checked(const char* name, std::int32_t value) {
    if (value >= 0) return static_cast<std::size_t>(value);
    fail(fmt::format("{} is {}, must not be negative", name, value));
    return 0;
  }

  ByteView bytes_;
  std::size_t at_ = 0;
  std::string problem_;
};

constexpr std::size_t kTransform = 7 * 8;
constexpr std::size_t kCovariance = 36 * 8;
constexpr std::size_t kBodyMotion = kTransform + kCovariance + 4 + 2 * 8;
constexpr std::size_t kBodyPose = 2 * 8 + kTransform + kCovariance + 4 + 2 * 8;

void image(Cursor& c) {
  c.skip(8 + 4 * 4);
  c.array(c.count32("size"), 1);
  const auto entries = c.count32("nmetadata");
  for (std::size_t i = 0; i < entries && c.good(); ++i) {
    c.string();
    c.array(c.count32("n"), 1);
  }
}

void stageTimes(Cursor& c) {
  const auto stages = c.count16("n_stages");
  c.strings(stages);
  c.array(stages, 8);
}

void joints(Cursor& c) {
  const auto joints = c.count16("num_joints");
  c.strings(joints);
  c.array(joints, 3 * 4);
}

}  // namespace

std::string layoutProblem(ByteView body, const bot_core::images_t*) {
  Cursor c(body);
  c.skip(8);
  const auto images = c.count32("n_images");
  c.array(images, 2);
  // An empty image takes 32 bytes, so this bounds what the decoder allocates.
  if (c.good() && images > c.left() / 32) c.fail(fmt::format("{} images do not fit", images));
  for (std::size_t i = 0; i < images && c.good(); ++i) image(c);
  return c.finish();
}

std::string layoutProblem(ByteView body, const bot_core::joint_state_t*) {
  Cursor c(body);
  c.skip(8);
  joints(c);
  return c.finish();
}

std::string layoutProblem(ByteView body, const bot_core::pose_t*) {
  Cursor c(body);
  c.skip(8 + 16 * 8);
  return c.finish();
}

std::string layoutProblem(ByteView body, const bot_core::rigid_transform_t*) {
  Cursor c(body);
  c.skip(8 + 7 * 8);
  return c.finish();
}

std::string layoutProblem(ByteView body, const bot_core::robot_state_t*) {
  Cursor c(body);
  c.skip(8 + kTransform + 6 * 8);
  joints(c);
  c.skip(24 * 4);
  return c.finish();
}

std::string layoutProblem(ByteView body, const bot_core::system_status_t*) {
  Cursor c(body);
  c.skip(8 + 3);
  c.string();
  return c.finish();
}

std::string layoutProblem(ByteView body, const pronto::update_t*) {
  Cursor c(body);
  c.skip(2 * 8 + kTransform + kCovariance + 1);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::body_pose_t*) {
  Cursor c(body);
  c.skip(kBodyPose);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::camera_t*) {
  Cursor c(body);
  c.skip(8);
  c.string();
  c.skip(2 * 4 + 9 * 8);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::command_t*) {
  Cursor c(body);
  c.skip(2 * 8);
  c.string();
  c.skip(4);
  c.string();
  c.skip(4);
  c.array(c.count32("n_chunks"), 4);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::frame_tick_t*) {
  Cursor c(body);
  c.skip(3 * 8 + 4);
  c.string();
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::grasp_t*) {
  Cursor c(body);
  c.skip(8 + 1 + kTransform);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::model_chunk_t*) {
  Cursor c(body);
  c.skip(2 * 8 + 3 * 4 + 8);
  c.array(c.count32("n"), 8 * 4 + 3);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::model_state_t*) {
  Cursor c(body);
  c.skip(2 * 8 + kBodyPose + 2 + kBodyPose + 2 * 8 + 3 * 4);
  c.array(c.count32("depth_size"), 1);
  c.array(c.count32("body_size"), 1);
  stageTimes(c);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::motion_prior_t*) {
  Cursor c(body);
  c.skip(3 * 8 + 4 + 2 * kTransform + kCovariance + 2 * 4 + 2 * kTransform + kCovariance);
  c.array(c.count32("n_shapes"), 4 + 3 * 8 + kTransform);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::planar_twist_t*) {
  Cursor c(body);
  c.skip(4 * 8);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::segmentation_t*) {
  Cursor c(body);
  c.skip(3 * 8 + 4 + 4 + 2 * 4);
  c.array(c.count32("label_size"), 1);
  c.array(c.count32("score_size"), 1);
  c.array(c.count32("n_clusters"), 4);
  c.skip(2 * kBodyMotion + 3 * 8);
  c.string();
  c.skip(2 * (1 + kTransform));
  stageTimes(c);
  return c.finish();
}

std::string layoutProblem(ByteView body, const rigidfusion::service_status_t*) {
  Cursor c(body);
  c.skip(3 * 8);
  c.strings(2);
  c.skip(4);
  c.string();
  c.skip(4);
  c.string();
  c.skip(7 * 8 + 7 * 8 + 2 * 4 + 3 * 8 + 8);
  const auto stages = c.count16("n_stages");
  c.strings(stages);
  c.array(stages, 8);
  return c.finish();
}

std::uint64_t wireHash(ByteView bytes) {
  if (bytes.size() < 8) return 0;
  std::uint64_t hash = 0;
  for (int i = 0; i < 8; ++i) hash = hash << 8U | bytes[static_cast<std::size_t>(i)];
  return hash;
}

std::string hashProblem(const char* type, std::uint64_t found, std::uint64_t expected) {
  return fmt::format("not a {}: its hash is {:016x}, not {:016x}", type, found, expected);
}

}  // namespace rf
