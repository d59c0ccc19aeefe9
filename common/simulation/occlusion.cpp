// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/occlusion.hpp"

#include <algorithm>
#include <array>

namespace rf::sim {
namespace {

using Eigen::Vector3f;
constexpr int kLeaf = 3;
constexpr float kClear = 1e-3F;

/// Whether the segment o + t d, t in (0, 1), crosses the box.
inline bool crosses(const Vector3f& low, const Vector3f& high, const Vector3f& o,
                    const Vector3f& inverse) {
  const Vector3f a = (low - o).cwiseProduct(inverse);
  const Vector3f b = (high - o).cwiseProduct(inverse);
  const float enter = a.cwiseMin(b).maxCoeff();
  const float leave = a.cwiseMax(b).minCoeff();
  return enter <= leave && leave > 0 && enter < 1;
}

}  // namespace

Occlusion::Occlusion(const World& world, std::span<const SE3> T_WB,
                     std::span<const int> primitives) {
  for (const int i : primitives) {
    const Primitive& p = world.primitives[static_cast<std::size_t>(i)];
    if (world.materials[static_cast<std::size_t>(p.material[0])].glow > 0) continue;
    const SE3 T_WP = T_WB[static_cast<std::size_t>(p.body)] * p.T_BP;
    const SE3 T_PW = T_WP.inverse();
    const Vec3 reach = T_WP.R().cwiseAbs() * p.half;
    solids_.push_back({T_PW.R().cast<float>(), T_PW.t.cast<float>(), p.half.cast<float>(), p.kind,
                       (T_WP.t - reach).cast<float>(), (T_WP.t + reach).cast<float>()});
  }
  if (solids_.empty()) return;
  build(0, static_cast<int>(solids_.size()));
  centre_ = 0.5F * (nodes_[0].low + nodes_[0].high);
  square_radius_ = 1.01F * (nodes_[0].high - centre_).squaredNorm() + 1e-4F;
}

int Occlusion::build(int first, int count) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Vector3f low = Vector3f::Constant(1e9F);
  Vector3f high = -low;
  for (int i = first; i < first + count; ++i) {
    low = low.cwiseMin(solids_[static_cast<std::size_t>(i)].low);
    high = high.cwiseMax(solids_[static_cast<std::size_t>(i)].high);
  }
  Node node{low, high, first, count, -1};
  if (count > kLeaf) {
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const auto begin = solids_.begin() + first;
    const int half = count / 2;
    std::nth_element(begin, begin + half, begin + count, [&](const Solid& a, const Solid& b) {
      return a.low[axis] + a.high[axis] < b.low[axis] + b.high[axis];
    });
    build(first, half);
    node.right = build(first + half, count - half);
    node.count = 0;
  }
  nodes_[static_cast<std::size_t>(index)] = node;
  return index;
}

bool Occlusion::passesBy(const Vector3f& from, const Vector3f& d) const {
  const Vector3f to_centre = centre_ - from;
  const float square = d.squaredNorm();
  const float along = std::clamp(to_centre.dot(d), 0.0F, square);
  // |to_centre - (along / square) d|^2, times square.
  const float distance = square * to_centre.squaredNorm() + along * (along - 2 * to_centre.dot(d));
  return distance > square * square_radius_;
}

bool Occlusion::blocked(const Vector3f& from, const Vector3f& to) const {
  if (nodes_.empty()) return false;
  const Vector3f d = to - from;
  if (passesBy(from, d)) return false;
  const Vector3f inverse = d.cwiseInverse();
  const float near = kClear / std::max(d.norm(), kClear);
  std::array<int, 64> stack{};
  int depth = 1;
  while (depth > 0) {
    const int at = stack[static_cast<std::size_t>(--depth)];
    const Node& node = nodes_[static_cast<std::size_t>(at)];
    if (!crosses(node.low, node.high, from, inverse)) continue;
    if (node.right >= 0) {
      stack[static_cast<std::size_t>(depth++)] = node.right;
      stack[static_cast<std::size_t>(depth++)] = at + 1;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const Solid& s = solids_[static_cast<std::size_t>(i)];
      const ShapeHit hit = intersect(s.kind, s.half, s.R_PW * from + s.t_PW, s.R_PW * d, near);
      if (hit.t > 0 && hit.t < 1 - near) return true;
    }
  }
  return false;
}

}  // namespace rf::sim
