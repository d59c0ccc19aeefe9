// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "values/stamped_pose.hpp"

namespace rf {

/// Holds back the first poses of each body until it has lived for longer than a false alarm may
/// (fusion.object.false_birth_frames): a body that is gone before was none. Its pose would
/// otherwise stand first in a trajectory whose other poses are those of another body, in another
/// frame O.
class NewbornPoses {
 public:
  /// `probation`: poses of a body that are held back at most; 0 or less: none.
  explicit NewbornPoses(int probation) : probation_(probation) {}

  /// Takes a pose T_WO of the body that exists; the poses that are good to write now, in order.
  std::vector<StampedPose> add(const StampedPose& pose);

  /// There is no body: what is held back was a false alarm.
  void gone();

  /// What is still held back of a body that exists: at the end of a run.
  std::vector<StampedPose> rest();

 private:
  int probation_;
  bool grown_ = false;  ///< the body that exists has passed its probation
  std::vector<StampedPose> held_;
};

}  // namespace rf
