// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "geometry/se3.hpp"
#include "values/surfel_point.hpp"

namespace rf::render {

/// From where a model is looked at. Viewer frame: x right, y down, z away from the viewer.
struct View {
  int width = 0;
  int height = 0;
  bool orthographic = false;
  double scale = 1;  ///< perspective: focal length in pixels; orthographic: pixels per metre
  SE3 T_VW;
};

/// The view from `eye` towards `target`, `up` pointing up in the picture; world coordinates. `up`
/// must not be parallel to the line of sight.
SE3 lookAt(const Vec3& eye, const Vec3& target, const Vec3& up);

/// A picture that surfels are drawn into, nearest first wins.
struct Raster {
  cv::Mat colour;  ///< 8-bit BGR
  cv::Mat depth;   ///< float metres along the line of sight, +inf where nothing is drawn
};
Raster emptyRaster(const View& view);

/// Draws surfels as discs lit from the viewer. Those that face away are left out, so that walls and
/// ceilings are seen through from behind. `T_WM` maps the model's coordinates to the world;
/// `tint` in 0..1 mixes in red, to tell the moving body from the world.
void splat(const std::vector<SurfelPoint>& surfels, const SE3& T_WM, const View& view, double tint,
           Raster& raster);

/// Pixel of a world point; z is its depth.
Vec3 toPixel(const View& view, const Vec3& point_W);

}  // namespace rf::render
