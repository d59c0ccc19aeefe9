// SPDX-License-Identifier: BSD-3-Clause
#include "splat.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rf::render {
namespace {

constexpr double kNearest = 0.15;         ///< metres; nearer surfels are not drawn
constexpr double kUnknownRadius = 0.006;  ///< metres; of points that carry none
constexpr double kRadiusFactor = 1.3;     ///< closes the gaps that circles leave
constexpr double kMaxRadiusPx = 60;
constexpr double kGrazing = 0.05;  ///< cosine below which a disc counts as facing away

/// A surfel in the viewer's frame.
struct Disc {
  Vec3 centre;
  Vec3 normal;
  double radius;
};

/// Depth at which the line of sight of pixel (u, v) meets the disc, or +inf.
double hitDepth(const Disc& disc, const View& view, int u, int v) {
  const double a = (u - view.width / 2.0) / view.scale;
  const double b = (v - view.height / 2.0) / view.scale;
  const Vec3 origin = view.orthographic ? Vec3(a, b, 0) : Vec3::Zero();
  const Vec3 direction = view.orthographic ? Vec3(0, 0, 1) : Vec3(a, b, 1);
  const double t = disc.normal.dot(disc.centre - origin) / disc.normal.dot(direction);
  const Vec3 hit = origin + t * direction;
  if ((hit - disc.centre).squaredNorm() > disc.radius * disc.radius) {
    return std::numeric_limits<double>::infinity();
  }
  return hit.z();
}

cv::Vec3b shaded(const SurfelPoint& s, double cosine, double tint) {
  const double light = 0.35 + 0.65 * cosine;
  const cv::Vec3d lit(s.blue * light, s.green * light, s.red * light);
  const cv::Vec3d mixed = lit * (1 - tint) + cv::Vec3d(30, 30, 235) * (light * tint);
  return {cv::saturate_cast<std::uint8_t>(mixed[0]), cv::saturate_cast<std::uint8_t>(mixed[1]),
          cv::saturate_cast<std::uint8_t>(mixed[2])};
}

void drawPixel(Raster& raster, int u, int v, double z, const cv::Vec3b& colour) {
  auto& nearest = raster.depth.at<float>(v, u);
  if (z >= nearest) return;
  nearest = static_cast<float>(z);
  raster.colour.at<cv::Vec3b>(v, u) = colour;
}

void drawDisc(const Disc& disc, const View& view, const cv::Vec3b& colour, Raster& raster) {
  const double per_metre = view.orthographic ? view.scale : view.scale / disc.centre.z();
  const double radius_px = std::min(kMaxRadiusPx, disc.radius * per_metre);
  const Eigen::Vector2d middle(disc.centre.x() * per_metre + view.width / 2.0,
                               disc.centre.y() * per_metre + view.height / 2.0);
  const int u0 = std::max(0, static_cast<int>(std::floor(middle.x() - radius_px)));
  const int v0 = std::max(0, static_cast<int>(std::floor(middle.y() - radius_px)));
  const int u1 = std::min(view.width - 1, static_cast<int>(std::ceil(middle.x() + radius_px)));
  const int v1 = std::min(view.height - 1, static_cast<int>(std::ceil(middle.y() + radius_px)));
  for (int v = v0; v <= v1; ++v) {
    for (int u = u0; u <= u1; ++u) {
      const double z = hitDepth(disc, view, u, v);
      if (std::isfinite(z)) drawPixel(raster, u, v, z, colour);
    }
  }
}

}  // namespace

SE3 lookAt(const Vec3& eye, const Vec3& target, const Vec3& up) {
  const Vec3 z = (target - eye).normalized();
  const Vec3 x = z.cross(up).normalized();
  Mat3 R_WV;
  R_WV.col(0) = x;
  R_WV.col(1) = z.cross(x);
  R_WV.col(2) = z;
  return SE3(R_WV, eye).inverse();
}

Raster emptyRaster(const View& view) {
  return {
      cv::Mat(view.height, view.width, CV_8UC3, cv::Scalar(250, 248, 246)),
      cv::Mat(view.height, view.width, CV_32F, cv::Scalar(std::numeric_limits<float>::infinity()))};
}

void splat(const std::vector<SurfelPoint>& surfels, const SE3& T_WM, const View& view, double tint,
           Raster& raster) {
  const SE3 T_VM = view.T_VW * T_WM;
  const Mat3 R_VM = T_VM.R();
  for (const SurfelPoint& s : surfels) {
    const Vec3 centre = R_VM * Vec3(s.x, s.y, s.z) + T_VM.t;
    if (!view.orthographic && centre.z() < kNearest) continue;
    const Vec3 sight = view.orthographic ? Vec3(0, 0, 1) : Vec3(centre.normalized());
    Vec3 normal = R_VM * Vec3(s.nx, s.ny, s.nz);
    if (normal.squaredNorm() < 0.25) normal = -sight;  // a point without a normal faces the viewer
    const double cosine = -normal.dot(sight);
    if (cosine < kGrazing) continue;
    const double radius = s.radius > 0 ? double(s.radius) : kUnknownRadius;
    const Disc disc{centre, normal, kRadiusFactor * radius};
    drawDisc(disc, view, shaded(s, cosine, tint), raster);
  }
}

Vec3 toPixel(const View& view, const Vec3& point_W) {
  const Vec3 p = view.T_VW * point_W;
  const double per_metre = view.orthographic ? view.scale : view.scale / std::max(p.z(), 1e-3);
  return {p.x() * per_metre + view.width / 2.0, p.y() * per_metre + view.height / 2.0, p.z()};
}

}  // namespace rf::render
