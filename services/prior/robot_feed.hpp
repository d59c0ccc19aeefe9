// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "messaging/robot_samples.hpp"
#include "messaging/service.hpp"
#include "priors/robot_prior.hpp"

namespace rf {

/// Moves a live robot's messages from their channels into its prior; says and counts what is wrong
/// with them.
class RobotFeed {
 public:
  /// Listens on the configured channels. Throws std::invalid_argument for a type that is not known,
  /// or two types on one channel.
  RobotFeed(Service& service, const RobotChannels& channels);

  /// Takes all that arrived.
  void take(RobotPrior& robot);

 private:
  struct Ear {
    std::string channel;
    std::string type;
    bool odometry = false;
    bool joints = false;
    Inbox::Box box = 0;
  };
  void listen(const std::string& channel, const std::string& type, bool odometry, bool joints);
  void takeSample(const Ear& ear, const RobotSample& sample, RobotPrior& robot);
  void say(const Ear& ear, const char* part, std::int64_t utime, const std::string& said);

  Service& service_;
  std::vector<Ear> ears_;
  std::optional<bool> held_;  ///< by the newest grasp
};

}  // namespace rf
