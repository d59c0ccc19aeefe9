// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "geometry/se3.hpp"
#include "segmentation/image_terms.hpp"
#include "segmentation/joint_solver.hpp"

namespace rf {

/// gamma~ (paper S_T): the last frame's scores (255 * gamma at the camera's size, 255 = static)
/// looked up at the frame's pixels through both motions, this frame -> last frame, and averaged per
/// cluster. A body that moves apart from the world needs its own motion, the world its own; the
/// mean serves both sides of a border. `label` has the level's size; labels from `clusters` on are
/// no cluster. A cluster that left the last image is static; all weights are 1.
ScorePrior warpScores(const Image<std::uint8_t>& previous, const Camera& mask_camera,
                      const TermLevel& level, const Image<std::uint8_t>& label,
                      std::size_t clusters, const SE3& step_s, const SE3& step_d);

/// Share of the clusters' pixels that is dynamic, 0..1; 0 where there is no cluster.
double dynamicShare(const Image<std::uint8_t>& label, const std::vector<float>& gamma);

/// 255 * gamma of each pixel's cluster, gamma limited to 0..1; 255 where there is no cluster.
Image<std::uint8_t> scoreImage(const Image<std::uint8_t>& label, const std::vector<float>& gamma);

}  // namespace rf
