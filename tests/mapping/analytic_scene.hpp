// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/se3.hpp"
#include "values/frame.hpp"
#include "values/segmentation_result.hpp"

namespace rf::test {

/// A textured box; faces are seen from inside when `inside` (a room).
struct SceneBox {
  SE3 T_WB;
  Vec3 half = Vec3::Ones();
  bool inside = false;
  double texture = 0;  ///< shifts the texture
  bool dynamic = false;
};

struct Scene {
  std::vector<SceneBox> boxes;
};

/// What a ray-cast of the scene gives for one frame.
struct Shot {
  RgbdFrame frame;
  Image<std::uint8_t> dynamic;  ///< 1 where a dynamic box is seen
};

struct ShotNoise {
  double depth = 0;   ///< factor on the sensor model's depth noise
  double colour = 0;  ///< grey levels
  std::uint64_t seed = 1;
};

/// A room of 5 x 2.6 x 5 m around the origin with two static boxes in it.
Scene room();

/// A moving box of the given size; its pose is the box's centre.
SceneBox movingBox(const SE3& T_WB, const Vec3& half);

Camera testCamera(int width = 320, int height = 240);

/// A camera that sways in front of the room's middle: its pose in frame k.
SE3 cameraAt(int k);

/// Smooth colour of a surface point, 0..1.
double textureAt(const Vec3& p, double shift);

Shot shoot(const Scene& scene, const SE3& T_WC, const Camera& camera, const ShotNoise& noise,
           std::int64_t seq);

/// A segmentation result with the true mask and given motions.
SegmentationResult truth(const Shot& shot, const Shot* previous, const SE3& camera_motion,
                         const SE3& object_motion, bool moving);

}  // namespace rf::test
