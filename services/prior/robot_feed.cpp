// SPDX-License-Identifier: BSD-3-Clause
#include "robot_feed.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace rf {
namespace {
constexpr std::size_t kMailbox = 4096;
}

RobotFeed::RobotFeed(Service& service, const RobotChannels& channels) : service_(service) {
  checkOdometryType(channels.odometry_type, "prior.robot.channels.odometry_type");
  checkJointsType(channels.joints_type, "prior.robot.channels.joints_type");
  listen(channels.odometry, channels.odometry_type, true, false);
  listen(channels.joints, channels.joints_type, false, true);
  listen(channels.grasp, "grasp_t", false, false);
}

void RobotFeed::listen(const std::string& channel, const std::string& type, bool odometry,
                       bool joints) {
  if (channel.empty()) return;
  for (Ear& ear : ears_) {
    if (ear.channel != channel) continue;
    if (ear.type != type) {
      throw std::invalid_argument(
          fmt::format("prior.robot.channels: {} is given for {} and for {}, must carry one type",
                      channel, ear.type, type));
    }
    ear.odometry |= odometry;
    ear.joints |= joints;
    return;
  }
  ears_.push_back(
      {channel, type, odometry, joints, service_.listen(Side::kState, channel, kMailbox)});
}

void RobotFeed::take(RobotPrior& robot) {
  for (const Ear& ear : ears_) {
    while (const auto raw = service_.takeRaw(ear.box)) {
      const auto sample = robotSample(ear.type, raw->bytes);
      if (sample) {
        takeSample(ear, *sample, robot);
      } else {
        service_.badInput(raw->channel + ": " + sample.error);
      }
    }
  }
}

void RobotFeed::takeSample(const Ear& ear, const RobotSample& sample, RobotPrior& robot) {
  const std::int64_t utime = sample.utime;
  if (ear.odometry && sample.pose) {
    say(ear, "pose", utime,
        robot.odometry().addPose(utime, sample.pose->T_WB, sample.pose->stated));
  }
  if (ear.odometry && sample.twist)
    say(ear, "twist", utime, robot.odometry().addTwist(utime, *sample.twist));
  if (ear.odometry && sample.increment) {
    say(ear, "increment", utime,
        robot.odometry().addIncrement(sample.increment->from_utime, utime,
                                      sample.increment->T_prev_now));
  }
  if (ear.joints && sample.joints) {
    say(ear, "joints", utime,
        robot.joints().add(utime, sample.joints->names, sample.joints->positions));
  }
  if (sample.grasp) {
    say(ear, "grasp", utime, robot.grasps().add(*sample.grasp));
    if (held_ != sample.grasp->held) {
      held_ = sample.grasp->held;
      service_.info(fmt::format("{}: from {} on the object is {}", ear.channel, utime,
                                sample.grasp->held ? "held" : "not held"));
    }
  }
}

void RobotFeed::say(const Ear& ear, const char* part, std::int64_t utime, const std::string& said) {
  if (said.empty()) return;
  service_.monitor().bad();
  service_.warn(fmt::format("{}: {} at {}: {}", ear.channel, part, utime, said));
}

}  // namespace rf
