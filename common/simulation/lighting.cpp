// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/lighting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "geometry/parallel.hpp"

namespace rf::sim {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr int kLampColumns = 4;
constexpr float kPatchSize = 0.10F;    // metres between light samples of a face
constexpr float kAmbientReach = 0.9F;  // metres: what is further away darkens nothing
constexpr int kAmbientRays = 14;
constexpr float kLift = 0.004F;  // sample points stand this far off their surface

/// Directions spread evenly over the half sphere about n.
std::array<Vector3f, kAmbientRays> hemisphere(const Vector3f& n) {
  std::array<Vector3f, kAmbientRays> out;
  const Vector3f side =
      (std::abs(n.z()) < 0.9F ? Vector3f::UnitZ() : Vector3f::UnitX()).cross(n).normalized();
  const Vector3f other = n.cross(side);
  for (int i = 0; i < kAmbientRays; ++i) {
    const float height = std::sqrt((static_cast<float>(i) + 0.5F) / kAmbientRays);
    const float radius = std::sqrt(1 - height * height);
    const float angle = 2.399963F * static_cast<float>(i);
    out[static_cast<std::size_t>(i)] =
        height * n + radius * (std::cos(angle) * side + std::sin(angle) * other);
  }
  return out;
}

float openness(const Vector3f& p, const Vector3f& n, const Occlusion& solids) {
  int open = 0;
  for (const Vector3f& d : hemisphere(n)) {
    open += solids.blocked(p, Vector3f(p + kAmbientReach * d)) ? 0 : 1;
  }
  return 0.25F + 0.75F * static_cast<float>(open) / kAmbientRays;
}

/// Surface point of a face at the given surface coordinates: the inverse of surfaceCoordinates().
Vector3f pointOnFace(const Primitive& p, int face, const Vector2f& at) {
  const Vector3f h = p.half.cast<float>();
  const float u = at.x();
  const float v = at.y();
  if (p.kind == ShapeKind::kBox) {
    switch (face) {
      case 0:
        return {-h.x(), h.y() - u, h.z() - v};
      case 1:
        return {h.x(), u - h.y(), h.z() - v};
      case 2:
        return {u - h.x(), -h.y(), h.z() - v};
      case 3:
        return {h.x() - u, h.y(), h.z() - v};
      case 4:
        return {u - h.x(), v - h.y(), -h.z()};
      default:
        return {u - h.x(), h.y() - v, h.z()};
    }
  }
  if (p.kind == ShapeKind::kCylinder && face != 0) {
    return {u - h.x(), v - h.x(), face == 2 ? h.z() : -h.z()};
  }
  const float angle = u / h.x() - 3.14159265F;
  const float z = h.z() - v;
  const float ring = p.kind == ShapeKind::kCylinder
                         ? 1.0F
                         : std::sqrt(std::max(0.0F, 1 - z * z / (h.z() * h.z())));
  return {ring * h.x() * std::cos(angle), ring * h.y() * std::sin(angle), z};
}

int facesOf(const Primitive& p) {
  return p.kind == ShapeKind::kBox ? 6 : p.kind == ShapeKind::kCylinder ? 3 : 1;
}

}  // namespace

float ambientLight(const Vector3f& n) { return 0.25F + 0.06F * n.z(); }

LampLight::LampLight(const World& world) {
  for (const Lamp& lamp : world.lamps) {
    Group group{
        lamp.centre_W.cast<float>(), static_cast<float>(lamp.half.head<2>().norm() + 0.03), {}};
    for (int i = 0; i < kLampColumns; ++i) {
      const double x = lamp.half.x() * (2.0 * (i + 0.5) / kLampColumns - 1.0);
      const double y = lamp.half.y() * (i % 2 == 0 ? -0.5 : 0.5);
      group.points.push_back({(lamp.centre_W + Vec3(x, y, -0.02)).cast<float>(), lamp.power});
    }
    groups_.push_back(std::move(group));
  }
  const Occlusion nothing(world, {}, {});
  const float middle = at(Vector3f::Zero(), Vector3f::UnitZ(), nothing).mean();
  if (middle > 0) scale_ = 0.75F / middle;
}

Vector3f LampLight::at(const Vector3f& p, const Vector3f& n, const Occlusion& hides,
                       Vector3f* unhidden) const {
  Vector3f light = Vector3f::Zero();
  Vector3f all = Vector3f::Zero();
  const Vector3f from = p + kLift * n;
  for (const Group& group : groups_) {
    for (const Point& point : group.points) {
      const Vector3f d = point.place - from;
      const float square = d.squaredNorm();
      const float cosines = n.dot(d) * d.z();
      if (cosines <= 0) continue;
      const Vector3f arriving = point.power * (scale_ * cosines / (square * square));
      all += arriving;
      if (hides.empty() || !hides.blocked(from, point.place)) light += arriving;
    }
  }
  if (unhidden != nullptr) *unhidden = all;
  return light;
}

BakedLight::BakedLight(const World& world, const LampLight& lamps) {
  std::vector<int> fixed;
  for (std::size_t i = 0; i < world.primitives.size(); ++i) {
    if (world.primitives[i].body == 0) fixed.push_back(static_cast<int>(i));
  }
  const std::vector<SE3> rest(static_cast<std::size_t>(world.bodies));
  const Occlusion solids(world, rest, fixed);
  patches_.resize(world.primitives.size());
  int total = 0;
  for (const int i : fixed) {
    const Primitive& p = world.primitives[static_cast<std::size_t>(i)];
    for (int face = 0; face < facesOf(p); ++face) {
      const Vector2f extent = surfaceExtent(p.kind, p.half.cast<float>(), face);
      Patch& patch = patches_[static_cast<std::size_t>(i)][static_cast<std::size_t>(face)];
      patch.first = total;
      patch.columns = std::clamp(static_cast<int>(extent.x() / kPatchSize), 1, 100);
      patch.rows = std::clamp(static_cast<int>(extent.y() / kPatchSize), 1, 100);
      patch.columns_per_metre = static_cast<float>(patch.columns) / extent.x();
      patch.rows_per_metre = static_cast<float>(patch.rows) / extent.y();
      total += patch.columns * patch.rows;
    }
  }
  values_.resize(static_cast<std::size_t>(total));
  parallelChunks(static_cast<int>(fixed.size()), [&](int chunk) {
    const auto i = static_cast<std::size_t>(fixed[static_cast<std::size_t>(chunk)]);
    const Primitive& p = world.primitives[i];
    const Eigen::Matrix3f R_WP = p.T_BP.R().cast<float>();
    const Vector3f t_WP = p.T_BP.t.cast<float>();
    for (int face = 0; face < facesOf(p); ++face) {
      const Patch& patch = patches_[i][static_cast<std::size_t>(face)];
      for (int k = 0; k < patch.columns * patch.rows; ++k) {
        const int row = k / patch.columns;
        const int column = k - row * patch.columns;
        const Vector2f at((static_cast<float>(column) + 0.5F) / patch.columns_per_metre,
                          (static_cast<float>(row) + 0.5F) / patch.rows_per_metre);
        const Vector3f p_P = pointOnFace(p, face, at);
        const Vector3f n = R_WP * surfaceNormal(p.kind, p.half.cast<float>(), face, p_P);
        const Vector3f p_W = R_WP * p_P + t_WP;
        Incident& value = values_[static_cast<std::size_t>(patch.first + k)];
        value.direct = lamps.at(p_W, n, solids);
        value.ambient = ambientLight(n) * openness(Vector3f(p_W + kLift * n), n, solids);
      }
    }
  });
}

Incident BakedLight::sample(int primitive, int face, const Vector2f& at) const {
  const Patch& patch =
      patches_[static_cast<std::size_t>(primitive)][static_cast<std::size_t>(face)];
  const float x = std::clamp(at.x() * patch.columns_per_metre - 0.5F, 0.0F,
                             static_cast<float>(patch.columns - 1));
  const float y =
      std::clamp(at.y() * patch.rows_per_metre - 0.5F, 0.0F, static_cast<float>(patch.rows - 1));
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  const float a = x - static_cast<float>(x0);
  const float b = y - static_cast<float>(y0);
  const auto value = [&](int i, int j) -> const Incident& {
    const int column = std::min(i, patch.columns - 1);
    const int row = std::min(j, patch.rows - 1);
    return values_[static_cast<std::size_t>(patch.first + row * patch.columns + column)];
  };
  const float w00 = (1 - a) * (1 - b);
  const float w10 = a * (1 - b);
  const float w01 = (1 - a) * b;
  const float w11 = a * b;
  const Incident& v00 = value(x0, y0);
  const Incident& v10 = value(x0 + 1, y0);
  const Incident& v01 = value(x0, y0 + 1);
  const Incident& v11 = value(x0 + 1, y0 + 1);
  return {w00 * v00.direct + w10 * v10.direct + w01 * v01.direct + w11 * v11.direct,
          w00 * v00.ambient + w10 * v10.ambient + w01 * v01.ambient + w11 * v11.ambient};
}

}  // namespace rf::sim
