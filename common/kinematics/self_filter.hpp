// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "kinematics/self_filter_config.hpp"
#include "values/robot_shape.hpp"

namespace rf {

/// Which pixels of a depth image show the robot itself.
struct SelfMask {
  Image<std::uint8_t> mask;  ///< of the depth image's size; 1 = robot
  int pixels = 0;            ///< how many are 1
  /// Pixels whose ray meets the inside of a shape (shrunk by the margin) but which measure
  /// something behind the shape: none where shapes, joints and the camera's place are right.
  int behind = 0;
};

/// Tells the robot's own pixels by its shapes' poses. A pixel is the robot's when its depth lies
/// between where its ray enters and where it leaves a shape that is grown by the margin, with
/// gate_sigma of the depth's noise on both sides. So what is held in front of the gripper stays,
/// and so does the room behind it. A camera inside a grown shape sees that shape from within: it
/// ends where the ray leaves it. Pixels without depth are never 1.
///
/// Rays follow the lens distortion of the camera: the mask is that of the image as the sensor gave
/// it. Deterministic; const members may run from several threads at once.
class SelfFilter {
 public:
  /// Throws std::invalid_argument when the calibration is unusable.
  SelfFilter(const SelfFilterConfig& config, const Camera& camera);

  /// `depth_mm`: whole millimetres, 0 = none. Throws std::invalid_argument naming index, value and
  /// rule when a shape's pose is not finite or no rigid transform, an extent is not positive and
  /// finite, there are more than kMaxRobotShapes, or the image is not of the camera's size.
  SelfMask find(std::span<const PosedShape> shapes, const Image<std::uint16_t>& depth_mm) const;

 private:
  struct Rectangle {
    int u0 = 0, v0 = 0, u1 = -1, v1 = -1;  ///< pixels, inclusive
  };
  Rectangle boundsOf(const PosedShape& shape) const;
  void mark(const PosedShape& shape, const Image<std::uint16_t>& depth_mm, SelfMask& out) const;

  SelfFilterConfig config_;
  Camera camera_;
  std::vector<Eigen::Vector2f> rays_;  ///< x/z, y/z of each pixel, row-major
  Eigen::Vector2d ray_min_, ray_max_;  ///< over the image
};

}  // namespace rf
