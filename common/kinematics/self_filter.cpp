// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/self_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace rf {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

constexpr double kNear = 0.02;           // metres; nothing nearer is bounded in the image
constexpr double kUnitTolerance = 1e-3;  // of a quaternion's norm
constexpr float kFar = 1e9F;

/// The part of a ray o + z d inside a solid, in units of the optical axis; empty: enter > leave.
struct Inside {
  float enter = 0;
  float leave = kFar;
  void cut(float a, float b) {
    enter = std::max(enter, a);
    leave = std::min(leave, b);
  }
  bool empty() const { return enter > leave; }
};

constexpr Inside kOutside = {1, 0};

/// Between two planes at +-half along one axis.
void cutSlab(float half, float o, float d, Inside& in) {
  if (std::abs(d) < 1e-12F) {
    if (std::abs(o) > half) in = kOutside;
    return;
  }
  const float a = (-half - o) / d;
  const float b = (half - o) / d;
  in.cut(std::min(a, b), std::max(a, b));
}

/// Where a z^2 + 2 b z + c <= 0.
void cutRound(float a, float b, float c, Inside& in) {
  if (a < 1e-12F) {  // along the axis
    if (c > 0) in = kOutside;
    return;
  }
  const float root = b * b - a * c;
  if (root < 0) {
    in = kOutside;
    return;
  }
  const float s = std::sqrt(root);
  in.cut((-b - s) / a, (-b + s) / a);
}

Inside insideOf(RobotShapeKind kind, const Vector3f& half, const Vector3f& o, const Vector3f& d) {
  Inside in;
  switch (kind) {
    case RobotShapeKind::kBox:
      for (int i = 0; i < 3 && !in.empty(); ++i) cutSlab(half[i], o[i], d[i], in);
      break;
    case RobotShapeKind::kCylinder:
      cutRound(d.head<2>().squaredNorm(), o.head<2>().dot(d.head<2>()),
               o.head<2>().squaredNorm() - half.x() * half.x(), in);
      if (!in.empty()) cutSlab(half.z(), o.z(), d.z(), in);
      break;
    case RobotShapeKind::kSphere:
      cutRound(d.squaredNorm(), o.dot(d), o.squaredNorm() - half.x() * half.x(), in);
      break;
  }
  return in;
}

/// Whether a ray comes from outside into the solid.
bool meets(const Inside& in) { return !in.empty() && in.enter > 0; }

void checkShape(const PosedShape& shape, std::size_t index) {
  const auto refuse = [&](const std::string& what) {
    throw std::invalid_argument(fmt::format("robot shape {}: {}", index, what));
  };
  if (!shape.T_CS.isFinite() || std::abs(shape.T_CS.q.norm() - 1) > kUnitTolerance) {
    refuse("its pose must be finite with a unit quaternion");
  }
  if (!shape.half.allFinite() || !(shape.half.minCoeff() > 0)) {
    refuse(fmt::format("half extents {} {} {} must be finite and positive", shape.half.x(),
                       shape.half.y(), shape.half.z()));
  }
  const int kind = static_cast<int>(shape.kind);
  if (kind < 0 || kind > 2) refuse(fmt::format("kind {} must be 0, 1 or 2", kind));
}

/// Bounds of x/z and y/z over a box, its edges cut at the near plane; empty when it is behind.
struct RayBounds {
  Vector2d low = Vector2d::Constant(std::numeric_limits<double>::max());
  Vector2d high = Vector2d::Constant(std::numeric_limits<double>::lowest());
  void cover(const Vec3& p) {
    const Vector2d ray = p.head<2>() / p.z();
    low = low.cwiseMin(ray);
    high = high.cwiseMax(ray);
  }
  bool empty() const { return low.x() > high.x(); }
};

RayBounds rayBounds(const SE3& T_CS, const Vec3& half) {
  RayBounds bounds;
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 sign((i & 1U) != 0 ? 1 : -1, (i & 2U) != 0 ? 1 : -1, (i & 4U) != 0 ? 1 : -1);
    corners[i] = T_CS * Vec3(sign.cwiseProduct(half));
  }
  for (std::size_t i = 0; i < 8; ++i) {
    if (corners[i].z() > kNear) bounds.cover(corners[i]);
    for (std::size_t bit = 1; bit < 8; bit <<= 1U) {
      const Vec3& a = corners[i];
      const Vec3& b = corners[i | bit];
      if ((i & bit) != 0 || (a.z() > kNear) == (b.z() > kNear)) continue;
      Vec3 cut = a + (kNear - a.z()) / (b.z() - a.z()) * (b - a);
      cut.z() = kNear;
      bounds.cover(cut);
    }
  }
  return bounds;
}

/// Pixel bounds of a rectangle of rays through the lens: of points along its rim.
void coverRim(const Camera& camera, const Vector2d& low, const Vector2d& high, Vector2d& from,
              Vector2d& to) {
  constexpr int kSteps = 16;
  from.setConstant(std::numeric_limits<double>::max());
  to.setConstant(std::numeric_limits<double>::lowest());
  for (int i = 0; i <= kSteps; ++i) {
    const Vector2d at = low + static_cast<double>(i) / kSteps * (high - low);
    for (const Vector2d& ray : {Vector2d(at.x(), low.y()), Vector2d(at.x(), high.y()),
                                Vector2d(low.x(), at.y()), Vector2d(high.x(), at.y())}) {
      const Vector2d ideal(camera.fx * ray.x() + camera.cx, camera.fy * ray.y() + camera.cy);
      const Vector2d px = camera.hasDistortion() ? camera.distort(ideal) : ideal;
      from = from.cwiseMin(px);
      to = to.cwiseMax(px);
    }
  }
}

}  // namespace

SelfFilter::SelfFilter(const SelfFilterConfig& config, const Camera& camera)
    : config_(config), camera_(camera) {
  if (const auto problem = camera.problem()) throw std::invalid_argument(*problem);
  ray_min_.setConstant(std::numeric_limits<double>::max());
  ray_max_.setConstant(std::numeric_limits<double>::lowest());
  rays_.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vector2d pixel(u, v);
      const Vector2d ideal = camera.hasDistortion() ? camera.undistort(pixel) : pixel;
      const Vector2d ray = camera.backProject(ideal.x(), ideal.y(), 1.0).head<2>();
      rays_.emplace_back(ray.cast<float>());
      ray_min_ = ray_min_.cwiseMin(ray);
      ray_max_ = ray_max_.cwiseMax(ray);
    }
  }
}

SelfFilter::Rectangle SelfFilter::boundsOf(const PosedShape& shape) const {
  RayBounds bounds = rayBounds(shape.T_CS, shape.half + Vec3::Constant(config_.margin_m));
  if (bounds.empty()) return {};
  bounds.low = bounds.low.cwiseMax(ray_min_);
  bounds.high = bounds.high.cwiseMin(ray_max_);
  if ((bounds.low.array() > bounds.high.array()).any()) return {};
  Vector2d from;
  Vector2d to;
  coverRim(camera_, bounds.low, bounds.high, from, to);
  const double slack = camera_.hasDistortion() ? 3.0 : 0.0;  // the rim between its points
  const auto place = [&](double x, int size) {
    return static_cast<int>(std::clamp(x, -1.0, static_cast<double>(size)));
  };
  Rectangle r;
  r.u0 = std::max(0, place(std::floor(from.x() - slack), camera_.width));
  r.v0 = std::max(0, place(std::floor(from.y() - slack), camera_.height));
  r.u1 = std::min(camera_.width - 1, place(std::ceil(to.x() + slack), camera_.width));
  r.v1 = std::min(camera_.height - 1, place(std::ceil(to.y() + slack), camera_.height));
  return r;
}

void SelfFilter::mark(const PosedShape& shape, const Image<std::uint16_t>& depth_mm,
                      SelfMask& out) const {
  const Rectangle r = boundsOf(shape);
  if (r.u0 > r.u1 || r.v0 > r.v1) return;
  const SE3 T_SC = shape.T_CS.inverse();
  const Eigen::Matrix3f R = T_SC.R().cast<float>();
  const Vector3f o = T_SC.t.cast<float>();
  const Vector3f grown = (shape.half + Vec3::Constant(config_.margin_m)).cast<float>();
  const Vector3f core = (shape.half - Vec3::Constant(config_.margin_m)).cast<float>();
  const bool has_core = core.minCoeff() > 0;
  for (int v = r.v0; v <= r.v1; ++v) {
    for (int u = r.u0; u <= r.u1; ++u) {
      if (depth_mm(u, v) == 0 || out.mask(u, v) == 1) continue;
      const std::size_t i = static_cast<std::size_t>(v) * static_cast<std::size_t>(camera_.width) +
                            static_cast<std::size_t>(u);
      const Vector3f d = R * Vector3f(rays_[i].x(), rays_[i].y(), 1.0F);
      const Inside in = insideOf(shape.kind, grown, o, d);
      if (in.empty()) continue;
      const float z = static_cast<float>(depth_mm(u, v)) * 1e-3F;
      const float from_near = std::max(0.0F, z - 0.4F);
      const float gate = static_cast<float>(
          config_.gate_sigma * (config_.sigma_base_m +
                                config_.sigma_growth * static_cast<double>(from_near * from_near)));
      if (z >= in.enter - gate && z <= in.leave + gate) {
        out.mask(u, v) = 1;
      } else if (z > in.leave && has_core && meets(insideOf(shape.kind, core, o, d))) {
        out.mask(u, v) = 2;  // behind; another shape may still claim it
      }
    }
  }
}

SelfMask SelfFilter::find(std::span<const PosedShape> shapes,
                          const Image<std::uint16_t>& depth_mm) const {
  if (shapes.size() > kMaxRobotShapes) {
    throw std::invalid_argument(
        fmt::format("{} robot shapes: at most {} are allowed", shapes.size(), kMaxRobotShapes));
  }
  if (depth_mm.width() != camera_.width || depth_mm.height() != camera_.height) {
    throw std::invalid_argument(fmt::format("depth image of {}x{} is not of the camera's {}x{}",
                                            depth_mm.width(), depth_mm.height(), camera_.width,
                                            camera_.height));
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) checkShape(shapes[i], i);
  SelfMask out{Image<std::uint8_t>(camera_.width, camera_.height), 0, 0};
  for (const PosedShape& shape : shapes) mark(shape, depth_mm, out);
  for (std::uint8_t& m : out.mask) {
    out.pixels += m == 1 ? 1 : 0;
    out.behind += m == 2 ? 1 : 0;
    m = m == 1 ? 1 : 0;
  }
  return out;
}

}  // namespace rf
