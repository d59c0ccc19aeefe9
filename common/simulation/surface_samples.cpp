// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "geometry/parallel.hpp"

namespace rf::sim {
namespace {

using Eigen::Vector3f;
constexpr std::size_t kChunk = 65536;
/// How far a point may lie behind or before the pixel's surface and still be that surface.
constexpr double kDepthTolerance = 0.015;

/// Metres along the normal by which the camera is behind a surface whatever the rounding.
constexpr float kSurelyBehind = 1e-4F;

using Sink = std::function<void(const Vec3& p)>;

int steps(double length, double spacing) {
  return std::max(1, static_cast<int>(std::ceil(length / spacing)));
}

void sampleBox(const Vec3& half, double spacing, int face, const Sink& sink) {
  const int axis = face / 2;
  const int a = (axis + 1) % 3;
  const int b = (axis + 2) % 3;
  const int na = steps(2 * half[a], spacing);
  const int nb = steps(2 * half[b], spacing);
  Vec3 p;
  p[axis] = face % 2 == 1 ? half[axis] : -half[axis];
  for (int i = 0; i < na; ++i) {
    p[a] = half[a] * (2.0 * (i + 0.5) / na - 1.0);
    for (int j = 0; j < nb; ++j) {
      p[b] = half[b] * (2.0 * (j + 0.5) / nb - 1.0);
      sink(p);
    }
  }
}

void sampleCylinder(const Vec3& half, double spacing, int face, const Sink& sink) {
  if (face == 0) {
    const int around = steps(2 * std::numbers::pi * half.x(), spacing);
    const int up = steps(2 * half.z(), spacing);
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      for (int j = 0; j < up; ++j) {
        sink({half.x() * std::cos(angle), half.x() * std::sin(angle),
              half.z() * (2.0 * (j + 0.5) / up - 1.0)});
      }
    }
    return;
  }
  const Vec3 square(half.x(), half.x(), half.z());
  sampleBox(square, spacing, face == 2 ? 5 : 4, [&](const Vec3& p) {
    if (p.head<2>().norm() <= half.x()) sink(p);
  });
}

void sampleEllipsoid(const Vec3& half, double spacing, const Sink& sink) {
  const double size = std::cbrt(half.x() * half.y() * half.z());
  const double area = 4 * std::numbers::pi * size * size;
  const int n = std::max(8, static_cast<int>(area / (spacing * spacing)));
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < n; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / n;
    const double r = std::sqrt(1.0 - z * z);
    sink(Vec3(r * std::cos(golden * i), r * std::sin(golden * i), z).cwiseProduct(half));
  }
}

void samplePrimitive(const Primitive& primitive, double spacing, std::vector<SurfacePoint>& out) {
  const Mat3 R = primitive.T_BP.R();
  const int faces = primitive.kind == ShapeKind::kBox        ? 6
                    : primitive.kind == ShapeKind::kCylinder ? 3
                                                             : 1;
  for (int face = 0; face < faces; ++face) {
    const Sink sink = [&](const Vec3& p) {
      const Vector3f n =
          surfaceNormal(primitive.kind, primitive.half.cast<float>(), face, p.cast<float>());
      out.push_back({(primitive.T_BP * p).cast<float>(), R.cast<float>() * n});
    };
    if (primitive.kind == ShapeKind::kBox) sampleBox(primitive.half, spacing, face, sink);
    if (primitive.kind == ShapeKind::kCylinder) sampleCylinder(primitive.half, spacing, face, sink);
    if (primitive.kind == ShapeKind::kEllipsoid) sampleEllipsoid(primitive.half, spacing, sink);
  }
}

}  // namespace

SurfaceSamples::SurfaceSamples(const World& world, double static_spacing, double body_spacing)
    : camera_(world.camera), bodies_(static_cast<std::size_t>(world.bodies)) {
  for (const Primitive& primitive : world.primitives) {
    Body& body = bodies_[static_cast<std::size_t>(primitive.body)];
    samplePrimitive(primitive, primitive.body == 0 ? static_spacing : body_spacing, body.points);
  }
  for (Body& body : bodies_) body.count.assign(body.points.size(), 0);
}

void SurfaceSamples::see(const SimulatedFrame& frame) {
  const SE3 T_CW = frame.T_WC.inverse();
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    Body& body = bodies_[b];
    const SE3 T_CB = T_CW * frame.T_WB[b];
    const Mat3 R_CB = T_CB.R();
    const Vector3f centre = T_CB.inverse().t.cast<float>();  // of the camera, in the body's frame
    const auto look = [&](std::size_t i) {
      const SurfacePoint& point = body.points[i];
      if (point.normal.dot(point.position - centre) > kSurelyBehind) return;
      const Vec3 p = R_CB * point.position.cast<double>() + T_CB.t;
      if (p.z() < 0.2) return;
      const Eigen::Vector2d px = camera_.project(p);
      const int u = static_cast<int>(std::lround(std::clamp(px.x(), -9.0, 1e5)));
      const int v = static_cast<int>(std::lround(std::clamp(px.y(), -9.0, 1e5)));
      if (!frame.depth.inside(u, v) || frame.depth(u, v) == 0) return;
      if (std::abs(static_cast<double>(frame.true_z(u, v)) - p.z()) > kDepthTolerance) return;
      const Vec3 n = R_CB * point.normal.cast<double>();
      if (n.dot(p) < 0 && body.count[i] < UINT16_MAX) ++body.count[i];
    };
    const auto chunks = static_cast<int>((body.points.size() + kChunk - 1) / kChunk);
    parallelChunks(chunks, [&](int chunk) {
      const std::size_t first = static_cast<std::size_t>(chunk) * kChunk;
      const std::size_t last = std::min(first + kChunk, body.points.size());
      for (std::size_t i = first; i < last; ++i) look(i);
    });
  }
}

std::vector<SurfacePoint> SurfaceSamples::seen(int body, int frames) const {
  const Body& b = bodies_.at(static_cast<std::size_t>(body));
  std::vector<SurfacePoint> out;
  for (std::size_t i = 0; i < b.points.size(); ++i) {
    if (b.count[i] >= frames) out.push_back(b.points[i]);
  }
  return out;
}

}  // namespace rf::sim
