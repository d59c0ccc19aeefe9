// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/newborn_poses.hpp"

#include <iterator>
#include <utility>

namespace rf {

std::vector<StampedPose> NewbornPoses::add(const StampedPose& pose) {
  held_.push_back(pose);
  grown_ = grown_ || std::ssize(held_) > probation_;
  return grown_ ? rest() : std::vector<StampedPose>{};
}

void NewbornPoses::gone() {
  grown_ = false;
  held_.clear();
}

std::vector<StampedPose> NewbornPoses::rest() { return std::exchange(held_, {}); }

}  // namespace rf
