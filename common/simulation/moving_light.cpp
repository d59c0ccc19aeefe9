// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/moving_light.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/parallel.hpp"

namespace rf::sim {
namespace {

using Eigen::Vector3f;
constexpr int kStep = 4;
constexpr int kOffset = 2;
constexpr float kOtherSurface = 0.02F;  // weight of a neighbour on another surface as far away

std::vector<int> movingPrimitives(const World& world) {
  std::vector<int> out;
  for (std::size_t i = 0; i < world.primitives.size(); ++i) {
    if (world.primitives[i].body > 0) out.push_back(static_cast<int>(i));
  }
  return out;
}

}  // namespace

MovingLight::MovingLight(const World& world, const LampLight& lamps, const Raycaster& caster,
                         const SurfaceImage& surface, std::span<const SE3> T_WB, const SE3& T_WC)
    : surface_(surface),
      world_(world),
      grid_((surface.z.width() + kStep - 1) / kStep, (surface.z.height() + kStep - 1) / kStep),
      open_(grid_.width(), grid_.height()) {
  const Occlusion bodies(world, T_WB, movingPrimitives(world));
  const Occlusion nothing(world, T_WB, {});
  const Eigen::Matrix3f R_WC = T_WC.R().cast<float>();
  const Vector3f t_WC = T_WC.t.cast<float>();
  const auto light = [&](int gu, int gv) {
    const int u = std::min(gu * kStep + kOffset, surface.z.width() - 1);
    const int v = std::min(gv * kStep + kOffset, surface.z.height() - 1);
    Sample& s = grid_(gu, gv);
    s.primitive = surface.primitive(u, v);
    s.face = surface.face(u, v);
    s.z = surface.z(u, v);
    if (s.primitive < 0) return;
    s.moving = world.primitives[static_cast<std::size_t>(s.primitive)].body > 0;
    if (!s.moving && bodies.empty()) return;
    const ViewedPrimitive& view = caster.viewed(s.primitive);
    const Vector3f p_C = s.z * world.camera.backProject(u, v, 1.0).cast<float>();
    const Vector3f p_P = view.origin + view.R_PC * p_C;
    const Vector3f n_W =
        R_WC * (view.R_PC.transpose() * surfaceNormal(view.kind, view.half, s.face, p_P));
    const Vector3f p_W = R_WC * p_C + t_WC;
    Vector3f unhidden;
    const Vector3f lit = lamps.at(p_W, n_W, bodies, &unhidden);
    s.value = s.moving ? lit : Vector3f(lit.cwiseQuotient(unhidden.cwiseMax(1e-6F)));
    if (!s.moving && unhidden.maxCoeff() <= 0) s.value = Vector3f::Ones();
  };
  parallelChunks(grid_.height(), [&](int gv) {
    for (int gu = 0; gu < grid_.width(); ++gu) light(gu, gv);
  });
  findOpen();
}

void MovingLight::findOpen() {
  const auto hidden = [&](int gu, int gv) {
    const Sample& s = grid_(std::min(gu, grid_.width() - 1), std::min(gv, grid_.height() - 1));
    return s.primitive >= 0 && !s.moving && s.value != Vector3f::Ones();
  };
  for (int v = 0; v < grid_.height(); ++v) {
    for (int u = 0; u < grid_.width(); ++u) {
      const bool any = hidden(u, v) || hidden(u + 1, v) || hidden(u, v + 1) || hidden(u + 1, v + 1);
      open_(u, v) = any ? 0 : 1;
    }
  }
}

Vector3f MovingLight::at(int u, int v) const {
  const std::int16_t primitive = surface_.primitive(u, v);
  const std::uint8_t face = surface_.face(u, v);
  const float z = surface_.z(u, v);
  const bool moving = world_.primitives[static_cast<std::size_t>(primitive)].body > 0;
  const float x = std::max(0.0F, static_cast<float>(u - kOffset) / kStep);
  const float y = std::max(0.0F, static_cast<float>(v - kOffset) / kStep);
  const int x0 = static_cast<int>(x);
  const int y0 = static_cast<int>(y);
  if (!moving && open_(x0, y0) != 0) return Vector3f::Ones();
  Vector3f sum = Vector3f::Zero();
  float total = 0;
  for (int k = 0; k < 4; ++k) {
    const int gu = std::min(x0 + k % 2, grid_.width() - 1);
    const int gv = std::min(y0 + k / 2, grid_.height() - 1);
    const Sample& s = grid_(gu, gv);
    if (s.primitive < 0 || s.moving != moving) continue;
    const bool same = s.primitive == primitive && s.face == face;
    if (!same && std::abs(s.z - z) > 0.05F * z) continue;
    const float a = std::max(0.05F, 1 - std::abs(x - static_cast<float>(gu)));
    const float b = std::max(0.05F, 1 - std::abs(y - static_cast<float>(gv)));
    const float weight = a * b * (same ? 1.0F : kOtherSurface);
    sum += weight * s.value;
    total += weight;
  }
  if (total > 0) return sum / total;
  return Vector3f::Constant(moving ? 0.5F : 1.0F);
}

}  // namespace rf::sim
