// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "models.hpp"
#include "plot.hpp"
#include "values/stamped_pose.hpp"

namespace rf::render {

/// What frames.csv says of one frame.
struct FrameRow {
  std::int64_t seq = 0;
  std::string health;
  double dynamic_share = 0;
  bool has_share = false;
};

/// Rows of frames.csv by utime. Columns are found by name. Throws DatasetError naming the file and
/// what is missing.
std::map<std::int64_t, FrameRow> readFrameRows(const std::string& path);

/// Trajectories of camera and object by one source; empty where there is none.
struct Tracks {
  Trajectory camera;  ///< T_WC
  Trajectory object;  ///< T_WO
};

/// All lines of the plot, laid over each other at the first common time: priors and estimates are
/// moved into the truth's world by the camera's first pose (into the estimate's where there is no
/// truth). With true object poses, the object lines show the true object frame's origin (the
/// constant offset is taken at the first common pose), else `object_centre` (object frame), if it
/// is known. Without either, an object frame means something only where there is an object prior;
/// else it lies where the camera was at the object's birth, and the object is left out.
struct Overlaid {
  std::vector<Series> series;
  GroundPlane plane;
};
Overlaid overlayTracks(const Tracks& truth, const Tracks& prior, const Tracks& estimate,
                       const std::optional<Vec3>& object_centre);

}  // namespace rf::render
