// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "calibration/absolute_rows.hpp"
#include "calibration/relative_rows.hpp"

namespace rf::calibration {

/// Which times become rows and which are kept for the check.
struct RowOptions {
  double interval = 0.25;  ///< s between the poses of X that rows are made of
  double max_gap = 0.2;    ///< s; longest time without a pose of A that is bridged
  double block =
      5.0;  ///< s; every third block of this length (less in short recordings) is held out
  double max_speed = 3.0;  ///< m/s: a faster step of a pose is a jump
  double max_turn = 6.0;   ///< rad/s: likewise
};

/// Times that could not be used, and why.
struct DroppedRows {
  std::size_t not_covered = 0;  ///< A has no poses there, or a gap
  std::size_t frozen = 0;       ///< A repeats one pose while X moves
  std::size_t jumps = 0;        ///< A or X leaps
  std::size_t all() const { return not_covered + frozen + jumps; }
};

struct MotionRows {
  std::vector<MotionRow> fit;
  std::vector<MotionRow> held_out;
  DroppedRows dropped;
};

/// Adjoining motions of X, `options.interval` long, for which A has poses at the offset and some
/// hundredths of a second to either side.
MotionRows motionRows(const Path& A, const Path& X, double offset, const RowOptions& options);

struct PoseRows {
  std::vector<PoseRow> fit;
  std::vector<PoseRow> held_out;
  DroppedRows dropped;
};

/// Poses of X, `options.interval` apart, likewise.
PoseRows poseRows(const Path& A, const Path& X, double offset, const RowOptions& options);

/// Motions over about `baseline` seconds put together from adjoining rows.
std::vector<MotionRow> joined(const std::vector<MotionRow>& rows, double baseline);

}  // namespace rf::calibration
