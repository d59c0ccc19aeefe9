// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/robot_samples.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <stdexcept>

#include "messaging/convert_parts.hpp"

namespace rf {
namespace {

using Sampled = Result<RobotSample>;

SE3 pose(const double (&trans)[3], const double (&quat_wxyz)[4]) {
  return {Eigen::Quaterniond(quat_wxyz[0], quat_wxyz[1], quat_wxyz[2], quat_wxyz[3]),
          Vec3(trans[0], trans[1], trans[2])};
}

/// Velocities that are not numbers say nothing.
std::optional<StatedSpeed> stated(const Vec3& linear, const Vec3& angular) {
  const StatedSpeed speed{linear.norm(), angular.norm()};
  if (!std::isfinite(speed.speed + speed.turn)) return std::nullopt;
  return speed;
}

template <class Message>
RobotSample::Joints joints(const Message& m) {
  return {m.joint_name, {m.joint_position.begin(), m.joint_position.end()}};
}

Sampled sample(const bot_core::pose_t& m) {
  RobotSample out;
  out.utime = m.utime;
  out.pose = {pose(m.pos, m.orientation),
              stated(Vec3(m.vel[0], m.vel[1], m.vel[2]),
                     Vec3(m.rotation_rate[0], m.rotation_rate[1], m.rotation_rate[2]))};
  return out;
}

Sampled sample(const bot_core::rigid_transform_t& m) {
  RobotSample out;
  out.utime = m.utime;
  out.pose = {pose(m.trans, m.quat), std::nullopt};
  return out;
}

Sampled sample(const bot_core::joint_state_t& m) {
  RobotSample out;
  out.utime = m.utime;
  out.joints = joints(m);
  return out;
}

Sampled sample(const bot_core::robot_state_t& m) {
  const auto& t = m.pose.translation;
  const auto& q = m.pose.rotation;
  const auto& v = m.twist.linear_velocity;
  const auto& w = m.twist.angular_velocity;
  RobotSample out;
  out.utime = m.utime;
  out.pose = {SE3(Eigen::Quaterniond(q.w, q.x, q.y, q.z), Vec3(t.x, t.y, t.z)),
              stated(Vec3(v.x, v.y, v.z), Vec3(w.x, w.y, w.z))};
  out.joints = joints(m);
  return out;
}

Sampled sample(const pronto::update_t& m) {
  if (m.estimate_status != pronto::update_t::ESTIMATE_VALID) {
    return Sampled::failure(fmt::format("update_t: estimate_status is {}, only 1 (valid) is used",
                                        static_cast<int>(m.estimate_status)));
  }
  RobotSample out;
  out.utime = m.timestamp;
  out.increment = {m.prev_timestamp, pose(m.translation, m.rotation)};
  return out;
}

Sampled sample(const rigidfusion::planar_twist_t& m) {
  RobotSample out;
  out.utime = m.utime;
  out.twist = PlanarTwist{m.vx_mps, m.vy_mps, m.wz_radps};
  return out;
}

Sampled sample(const rigidfusion::grasp_t& m) {
  if (m.held != 0 && m.held != 1) {
    return Sampled::failure(
        fmt::format("grasp_t: held is {}, must be 0 or 1", static_cast<int>(m.held)));
  }
  RobotSample out;
  out.utime = m.utime;
  out.grasp = Grasp{m.utime, m.held == 1, rf::fromWire(m.T_GO)};
  return out;
}

template <class Message>
Sampled decodeSample(ByteView bytes) {
  const auto message = decodeMessage<Message>(bytes);
  if (!message) return Sampled::failure(message.error);
  return sample(*message);
}

template <std::size_t N>
void checkType(const std::string& type, const std::string& field,
               const std::array<const char*, N>& allowed) {
  std::string list;
  for (const char* name : allowed) {
    if (type == name) return;
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  throw std::invalid_argument(fmt::format("{} = {}: must be one of {}", field, type, list));
}

}  // namespace

void checkOdometryType(const std::string& type, const std::string& field) {
  checkType<5>(type, field,
               {"pose_t", "rigid_transform_t", "robot_state_t", "planar_twist_t", "update_t"});
}

void checkJointsType(const std::string& type, const std::string& field) {
  checkType<2>(type, field, {"joint_state_t", "robot_state_t"});
}

Result<RobotSample> robotSample(const std::string& type, ByteView bytes) {
  if (type == "pose_t") return decodeSample<bot_core::pose_t>(bytes);
  if (type == "rigid_transform_t") return decodeSample<bot_core::rigid_transform_t>(bytes);
  if (type == "joint_state_t") return decodeSample<bot_core::joint_state_t>(bytes);
  if (type == "robot_state_t") return decodeSample<bot_core::robot_state_t>(bytes);
  if (type == "update_t") return decodeSample<pronto::update_t>(bytes);
  if (type == "planar_twist_t") return decodeSample<rigidfusion::planar_twist_t>(bytes);
  if (type == "grasp_t") return decodeSample<rigidfusion::grasp_t>(bytes);
  throw std::invalid_argument("robotSample: unknown type " + type);
}

Bytes packTwist(std::int64_t utime, const PlanarTwist& twist) {
  rigidfusion::planar_twist_t m;
  m.utime = utime;
  m.vx_mps = twist.vx;
  m.vy_mps = twist.vy;
  m.wz_radps = twist.wz;
  return encodeMessage(m);
}

Bytes packGrasp(const Grasp& grasp) {
  rigidfusion::grasp_t m;
  m.utime = grasp.utime;
  m.held = static_cast<std::int8_t>(grasp.held);
  m.T_GO = toWire(grasp.held ? grasp.T_GO : SE3());
  return encodeMessage(m);
}

Bytes packJoints(std::int64_t utime, const RobotSample::Joints& joints) {
  if (joints.names.size() != joints.positions.size() || joints.names.size() > 32767) {
    throw std::invalid_argument(
        fmt::format("joints: {} names and {} positions, must be as many "
                    "and at most 32767",
                    joints.names.size(), joints.positions.size()));
  }
  bot_core::joint_state_t m;
  m.utime = utime;
  m.num_joints = static_cast<std::int16_t>(joints.names.size());
  m.joint_name = joints.names;
  m.joint_position.assign(joints.positions.begin(), joints.positions.end());
  m.joint_velocity.assign(joints.names.size(), 0);
  m.joint_effort.assign(joints.names.size(), 0);
  return encodeMessage(m);
}

}  // namespace rf
