// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "messaging/check.hpp"
#include "messaging/conversions.hpp"

namespace rf {
namespace {

constexpr double kForeignQuaternionTolerance = 0.01;
constexpr std::size_t kMaxChunkList = 4096;

void checkValue(Check& check, const ModelChunk& c) {
  check.rule(c.body == kBodyStatic || c.body == kBodyObject,
             fmt::format("body is {}, must be 1 or 2", c.body));
  check.rule(c.n_chunks >= 1 && c.chunk >= 0 && c.chunk < c.n_chunks,
             fmt::format("chunk {} of {}", c.chunk, c.n_chunks));
  check.rule(
      c.total_surfels >= static_cast<std::int64_t>(c.surfels.size()),
      fmt::format("{} surfels in total, {} in this chunk", c.total_surfels, c.surfels.size()));
  for (const SurfelPoint& s : c.surfels) {
    check.rule(std::isfinite(s.x + s.y + s.z + s.nx + s.ny + s.nz + s.radius + s.confidence),
               "a surfel is not finite");
  }
}

void checkValue(Check& check, const Command& c) {
  check.text("target", c.target);
  check.text("argument", c.argument);
  check.range("command", static_cast<int>(c.kind), 1, 5);
  check.range("body", c.body, 0, 2);
  check.rule(c.chunks.size() <= kMaxChunkList, fmt::format("{} chunks asked for", c.chunks.size()));
}

}  // namespace

Result<rigidfusion::model_chunk_t> toMessage(const ModelChunk& c) {
  Check check("model chunk");
  checkValue(check, c);
  if (!check.good()) return Result<rigidfusion::model_chunk_t>::failure(check.problem());
  rigidfusion::model_chunk_t out;
  out.utime = c.utime;
  out.request_id = c.request_id;
  out.body = c.body;
  out.chunk = c.chunk;
  out.n_chunks = c.n_chunks;
  out.total_surfels = c.total_surfels;
  out.n = static_cast<std::int32_t>(c.surfels.size());
  for (const SurfelPoint& s : c.surfels) {
    out.x.push_back(s.x);
    out.y.push_back(s.y);
    out.z.push_back(s.z);
    out.nx.push_back(s.nx);
    out.ny.push_back(s.ny);
    out.nz.push_back(s.nz);
    out.red.push_back(s.red);
    out.green.push_back(s.green);
    out.blue.push_back(s.blue);
    out.radius.push_back(s.radius);
    out.confidence.push_back(s.confidence);
  }
  return out;
}

Result<ModelChunk> toValue(const rigidfusion::model_chunk_t& m) {
  ModelChunk out;
  out.utime = m.utime;
  out.request_id = m.request_id;
  out.body = m.body == 1 || m.body == 2 ? static_cast<std::uint8_t>(m.body) : std::uint8_t{0};
  out.chunk = m.chunk;
  out.n_chunks = m.n_chunks;
  out.total_surfels = m.total_surfels;
  for (std::size_t i = 0; i < m.x.size(); ++i) {
    out.surfels.push_back({m.x[i], m.y[i], m.z[i], m.nx[i], m.ny[i], m.nz[i], m.red[i], m.green[i],
                           m.blue[i], m.radius[i], m.confidence[i]});
  }
  Check check("model_chunk_t");
  checkValue(check, out);
  if (!check.good()) return Result<ModelChunk>::failure(check.problem());
  return out;
}

Result<rigidfusion::command_t> toMessage(const Command& c) {
  Check check("command");
  checkValue(check, c);
  if (!check.good()) return Result<rigidfusion::command_t>::failure(check.problem());
  rigidfusion::command_t out;
  out.utime = c.utime;
  out.id = c.id;
  out.target = c.target;
  out.command = static_cast<std::int32_t>(c.kind);
  out.argument = c.argument;
  out.body = c.body;
  out.n_chunks = static_cast<std::int32_t>(c.chunks.size());
  out.chunks.assign(c.chunks.begin(), c.chunks.end());
  return out;
}

Result<Command> toValue(const rigidfusion::command_t& m) {
  Check check("command_t");
  check.range("command", m.command, 1, 5);
  check.range("body", m.body, 0, 2);
  if (!check.good()) return Result<Command>::failure(check.problem());
  Command out;
  out.utime = m.utime;
  out.id = m.id;
  out.target = m.target;
  out.kind = static_cast<CommandKind>(m.command);
  out.argument = m.argument;
  out.body = static_cast<std::uint8_t>(m.body);
  out.chunks.assign(m.chunks.begin(), m.chunks.end());
  checkValue(check, out);
  if (!check.good()) return Result<Command>::failure(check.problem());
  return out;
}

Result<bot_core::pose_t> toBotPose(const StampedPose& pose) {
  Check check("pose");
  check.transform("pose", pose.pose);
  if (!check.good()) return Result<bot_core::pose_t>::failure(check.problem());
  bot_core::pose_t out{};
  out.utime = pose.utime;
  for (int i = 0; i < 3; ++i) out.pos[i] = pose.pose.t[i];
  out.orientation[0] = pose.pose.q.w();
  out.orientation[1] = pose.pose.q.x();
  out.orientation[2] = pose.pose.q.y();
  out.orientation[3] = pose.pose.q.z();
  return out;
}

Result<StampedPose> toValue(const bot_core::pose_t& m) {
  StampedPose out;
  out.utime = m.utime;
  out.pose.t = Vec3(m.pos[0], m.pos[1], m.pos[2]);
  const Eigen::Quaterniond q(m.orientation[0], m.orientation[1], m.orientation[2],
                             m.orientation[3]);
  Check check("pose_t");
  check.rule(out.pose.t.allFinite() && q.coeffs().allFinite(),
             fmt::format("not finite: pos {} {} {}, orientation wxyz {} {} {} {}", m.pos[0],
                         m.pos[1], m.pos[2], q.w(), q.x(), q.y(), q.z()));
  check.rule(std::abs(q.norm() - 1) < kForeignQuaternionTolerance,
             fmt::format("orientation has length {}, must be 1", q.norm()));
  if (!check.good()) return Result<StampedPose>::failure(check.problem());
  out.pose.q = q.normalized();
  return out;
}

}  // namespace rf
