// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "values/stamped_pose.hpp"
#include "values/surfel_point.hpp"

namespace rf::render {

/// What the picture of the models shows.
struct ModelScene {
  std::vector<SurfelPoint> world;   ///< world frame
  std::vector<SurfelPoint> object;  ///< object frame; may be empty
  Trajectory camera;                ///< T_WC, at least one pose
  Trajectory object_path;           ///< T_WO; may be empty
};

/// The sky direction in the world frame: skyAxis of the camera's poses, refined on the normals of
/// horizontal surfaces (floor, tables) where there are enough.
Vec3 skyDirection(const std::vector<SurfelPoint>& world, const Trajectory& camera);

/// One picture: the world with the object at its last pose from behind and above the first camera;
/// a plan of the world (a wall that was mapped twice is seen as two lines); the object from two
/// sides.
cv::Mat modelPicture(const ModelScene& scene, const std::string& title);

}  // namespace rf::render
