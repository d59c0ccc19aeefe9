// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "canvas.hpp"
#include "values/stamped_pose.hpp"

namespace rf::render {

/// Two axes of a world frame to draw a map in, seen from above: `right` x `up` points to the sky.
struct GroundPlane {
  Vec3 right = Vec3::UnitX();
  Vec3 up = Vec3::UnitY();
  std::string right_name = "x";
  std::string up_name = "y";
};

/// The world axis that most likely points to the sky, judged from T_WC poses. A world that is the
/// first camera's own frame has y down. Any other is taken as z up (or down), as robots, motion
/// capture and the TUM recordings have it, unless the cameras' mean up direction (-y) contradicts;
/// then it is the axis nearest to that. An empty trajectory gives z.
Vec3 skyAxis(const Trajectory& camera);

/// The map plane of a world frame in which `sky`, one of its axes or their negatives, points up.
GroundPlane groundPlane(const Vec3& sky);

/// One line of the plot.
struct Series {
  std::string name;
  Colour colour;
  bool dashed = false;
  double thickness = 2;
  std::vector<Vec3> points;  ///< world frame, metres
};

/// Top-down plot with equal axes in metres, a legend, and markers: disc at the start, square at the
/// end. Series without points are left out. Where the first three (the camera's) fill only a small
/// part of the plot they are drawn once more, enlarged.
cv::Mat trajectoryPlot(const std::vector<Series>& series, const GroundPlane& plane,
                       const std::string& title, const std::string& note);

}  // namespace rf::render
