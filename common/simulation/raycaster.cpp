// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/raycaster.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "geometry/parallel.hpp"

namespace rf::sim {
namespace {

constexpr int kTile = 16;
constexpr float kNear = 0.05F;

/// Pixel bounds of a primitive's bounding box, its edges cut at the near plane.
void boundInImage(const Camera& camera, const SE3& T_CP, const Vec3& half, ViewedPrimitive& view) {
  std::array<Vec3, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 sign((i & 1U) != 0 ? 1 : -1, (i & 2U) != 0 ? 1 : -1, (i & 4U) != 0 ? 1 : -1);
    corners[i] = T_CP * Vec3(sign.cwiseProduct(half));
  }
  double u0 = 1e9, u1 = -1e9, v0 = 1e9, v1 = -1e9, nearest = 1e9;
  const auto cover = [&](const Vec3& p) {
    const Eigen::Vector2d px = camera.project(p);
    u0 = std::min(u0, px.x());
    u1 = std::max(u1, px.x());
    v0 = std::min(v0, px.y());
    v1 = std::max(v1, px.y());
    nearest = std::min(nearest, p.z());
  };
  for (std::size_t i = 0; i < 8; ++i) {
    if (corners[i].z() > kNear) cover(corners[i]);
    for (std::size_t bit = 1; bit < 8; bit <<= 1U) {
      const Vec3& a = corners[i];
      const Vec3& b = corners[i | bit];
      if ((i & bit) != 0 || (a.z() > kNear) == (b.z() > kNear)) continue;
      const double s = (kNear - a.z()) / (b.z() - a.z());
      cover(Vec3(a + s * (b - a)));
    }
  }
  view.nearest_z = -1;
  if (nearest > 1e8) return;
  const auto low = [](double x, int n) {
    return std::clamp(static_cast<int>(std::floor(x)), 0, n);
  };
  const auto clip = [](double x) { return std::clamp(x, -10.0, 1e5); };
  view.u0 = low(clip(u0), camera.width);
  view.v0 = low(clip(v0), camera.height);
  view.u1 = static_cast<int>(std::ceil(std::clamp(u1, -10.0, camera.width - 1.0)));
  view.v1 = static_cast<int>(std::ceil(std::clamp(v1, -10.0, camera.height - 1.0)));
  if (view.u0 > view.u1 || view.v0 > view.v1) return;
  view.nearest_z = static_cast<float>(nearest);
}

}  // namespace

Raycaster::Raycaster(const World& world, std::span<const SE3> T_WB, const SE3& T_WC)
    : camera_(world.camera) {
  if (T_WB.size() != static_cast<std::size_t>(world.bodies)) {
    throw std::invalid_argument("Raycaster: " + std::to_string(T_WB.size()) + " body poses for " +
                                std::to_string(world.bodies) + " bodies");
  }
  tiles_u_ = (camera_.width + kTile - 1) / kTile;
  tiles_v_ = (camera_.height + kTile - 1) / kTile;
  tiles_.resize(static_cast<std::size_t>(tiles_u_ * tiles_v_));
  views_.resize(world.primitives.size());
  const SE3 T_CW = T_WC.inverse();
  for (std::size_t i = 0; i < world.primitives.size(); ++i) {
    const Primitive& primitive = world.primitives[i];
    const SE3 T_CP = T_CW * T_WB[static_cast<std::size_t>(primitive.body)] * primitive.T_BP;
    const SE3 T_PC = T_CP.inverse();
    ViewedPrimitive& view = views_[i];
    view.R_PC = T_PC.R().cast<float>();
    view.origin = T_PC.t.cast<float>();
    view.half = primitive.half.cast<float>();
    view.kind = primitive.kind;
    boundInImage(camera_, T_CP, primitive.half, view);
    view.u_low = static_cast<float>(view.u0 - 1);
    view.u_high = static_cast<float>(view.u1 + 1);
    view.v_low = static_cast<float>(view.v0 - 1);
    view.v_high = static_cast<float>(view.v1 + 1);
    if (view.nearest_z >= 0) addToTiles(i);
  }
  for (auto& tile : tiles_) {
    std::stable_sort(tile.begin(), tile.end(), [&](std::int16_t a, std::int16_t b) {
      return viewed(a).nearest_z < viewed(b).nearest_z;
    });
  }
}

void Raycaster::addToTiles(std::size_t primitive) {
  const ViewedPrimitive& view = views_[primitive];
  for (int tv = view.v0 / kTile; tv <= view.v1 / kTile; ++tv) {
    for (int tu = view.u0 / kTile; tu <= view.u1 / kTile; ++tu) {
      tiles_[static_cast<std::size_t>(tv * tiles_u_ + tu)].push_back(
          static_cast<std::int16_t>(primitive));
    }
  }
}

Raycaster::Hit Raycaster::cast(float u, float v) const {
  const int tu = std::clamp(static_cast<int>(u) / kTile, 0, tiles_u_ - 1);
  const int tv = std::clamp(static_cast<int>(v) / kTile, 0, tiles_v_ - 1);
  const Eigen::Vector3f ray((u - static_cast<float>(camera_.cx)) / static_cast<float>(camera_.fx),
                            (v - static_cast<float>(camera_.cy)) / static_cast<float>(camera_.fy),
                            1.0F);
  Hit best;
  float limit = 1e9F;
  for (const std::int16_t i : tiles_[static_cast<std::size_t>(tv * tiles_u_ + tu)]) {
    const ViewedPrimitive& view = viewed(i);
    if (view.nearest_z > limit) break;
    if (u < view.u_low || u > view.u_high || v < view.v_low || v > view.v_high) continue;
    const ShapeHit hit = intersect(view.kind, view.half, view.origin, view.R_PC * ray, kNear);
    if (hit.t <= 0 || hit.t >= limit) continue;
    limit = hit.t;
    best = {hit.t, i, hit.face};
  }
  return best;
}

SurfaceImage Raycaster::castAll() const {
  SurfaceImage out{Image<float>(camera_.width, camera_.height),
                   Image<std::int16_t>(camera_.width, camera_.height, -1),
                   Image<std::uint8_t>(camera_.width, camera_.height)};
  parallelChunks(tiles_v_, [&](int chunk) {
    for (int v = chunk * kTile; v < std::min((chunk + 1) * kTile, camera_.height); ++v) {
      for (int u = 0; u < camera_.width; ++u) {
        const Hit hit = cast(static_cast<float>(u), static_cast<float>(v));
        out.z(u, v) = hit.z;
        out.primitive(u, v) = static_cast<std::int16_t>(hit.primitive);
        out.face(u, v) = static_cast<std::uint8_t>(hit.face);
      }
    }
  });
  return out;
}

}  // namespace rf::sim
