// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "geometry/se3.hpp"
#include "values/surfel_point.hpp"

namespace rf {

/// How much of a static map is a body that moves.
struct MapOnMoving {
  std::size_t frames = 0;   ///< with a true mask
  std::size_t surfels = 0;  ///< of the map
  std::size_t on_moving = 0;
  double share() const;  ///< of the surfels; 0 for an empty map
};

/// A frame of which it is known what moves.
struct MaskedDepth {
  Image<std::uint8_t> truth;      ///< 2 dynamic; anything else is not looked at
  Image<std::uint16_t> depth_mm;  ///< 0 none
  SE3 T_WC;                       ///< W: frame of the map's surfels
};

/// Counts the surfels of a static map that lie on what moves: that project, in at least one frame,
/// to a dynamic pixel whose depth is within `limit` metres of theirs. Adds frames one by one.
class MovingPixels {
 public:
  /// `camera` as calibrated, distortion included. The map must outlive this.
  MovingPixels(const std::vector<SurfelPoint>& map, const Camera& camera, double limit = 0.02);
  /// Throws std::invalid_argument when an image is not of the camera's size.
  void add(const MaskedDepth& frame);
  MapOnMoving result() const;

 private:
  bool onMoving(const SurfelPoint& s, const MaskedDepth& frame, const SE3& T_CW) const;

  const std::vector<SurfelPoint>& map_;
  Camera camera_;
  double limit_;
  std::size_t frames_ = 0;
  std::vector<std::uint8_t> marked_;
};

}  // namespace rf
