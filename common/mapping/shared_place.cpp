// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/shared_place.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rf {
namespace {

struct Oriented {
  Eigen::Vector3f point, normal;
};

std::vector<Oriented> stableSurfels(const SurfelMap& map, float stable) {
  std::vector<Oriented> out;
  out.reserve(static_cast<std::size_t>(map.size()));
  for (int i = 0; i < map.blocks(); ++i) {
    const SurfelBlock& b = map.block(i);
    for (int slot = 0; slot < b.count; ++slot) {
      const Surfel s = b.get(slot);
      if (s.logit >= stable && s.radius > 0) out.push_back({s.point, s.normal});
    }
  }
  return out;
}

// The object's surfels in cubic cells, one array sorted by cell.
class Cells {
 public:
  explicit Cells(const std::vector<Oriented>& surfels) {
    lower_ = upper_ = surfels.front().point;
    for (const Oriented& s : surfels) {
      lower_ = lower_.cwiseMin(s.point);
      upper_ = upper_.cwiseMax(s.point);
    }
    const Eigen::Vector3f extent = upper_ - lower_;
    side_ = std::max(kLeastSide, extent.maxCoeff() / kMostCells);
    for (int a = 0; a < 3; ++a) count_[a] = static_cast<int>(extent[a] / side_) + 1;
    begin_.assign(static_cast<std::size_t>(count_.prod()) + 1, 0);
    for (const Oriented& s : surfels) ++begin_[index(cellOf(s.point)) + 1];
    for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    sorted_.resize(surfels.size());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (const Oriented& s : surfels) sorted_[next[index(cellOf(s.point))]++] = s;
  }

  const Eigen::Vector3f& lower() const { return lower_; }
  const Eigen::Vector3f& upper() const { return upper_; }

  // Whether a surfel within `radius` faces the same side as `s`.
  bool has(const Oriented& s, float radius) const {
    const Eigen::Array3i from = cellOf(s.point - Eigen::Vector3f::Constant(radius)).max(0);
    const Eigen::Array3i to = cellOf(s.point + Eigen::Vector3f::Constant(radius)).min(count_ - 1);
    for (int z = from.z(); z <= to.z(); ++z) {
      for (int y = from.y(); y <= to.y(); ++y) {
        for (int x = from.x(); x <= to.x(); ++x) {
          if (anyIn(index({x, y, z}), s, radius)) return true;
        }
      }
    }
    return false;
  }

 private:
  static constexpr float kLeastSide = 0.03F;  // metres
  static constexpr float kMostCells = 96.0F;  // along an axis
  static constexpr float kSameSide = 0.3F;    // cosine: 70 degrees, edges are round in a map

  Eigen::Array3i cellOf(const Eigen::Vector3f& p) const {
    return ((p - lower_) / side_).array().floor().cast<int>();
  }
  std::size_t index(const Eigen::Array3i& c) const {
    return static_cast<std::size_t>((c.z() * count_.y() + c.y()) * count_.x() + c.x());
  }
  bool anyIn(std::size_t cell, const Oriented& s, float radius) const {
    for (std::size_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
      const Oriented& o = sorted_[i];
      if ((o.point - s.point).squaredNorm() < radius * radius && o.normal.dot(s.normal) > kSameSide)
        return true;
    }
    return false;
  }

  float side_ = 0;
  Eigen::Vector3f lower_, upper_;
  Eigen::Array3i count_;
  std::vector<std::size_t> begin_;
  std::vector<Oriented> sorted_;
};

// Whether a block's box may reach the cells' box (both with `margin`) under T_OF.
bool meets(const SurfelBlock& b, const Eigen::Matrix3f& R_OF, const Eigen::Vector3f& t_OF,
           const Cells& cells, float margin) {
  const Eigen::Vector3f half = R_OF.cwiseAbs() * (0.5F * (b.upper - b.lower));
  const Eigen::Vector3f centre = R_OF * (0.5F * (b.upper + b.lower)) + t_OF;
  const Eigen::Array3f low = (cells.lower() - half).array() - margin;
  const Eigen::Array3f high = (cells.upper() + half).array() + margin;
  return (centre.array() >= low).all() && (centre.array() <= high).all();
}

bool markShared(const Cells& cells, const RestPlace& place, SurfelBlock& b) {
  const auto margin = static_cast<float>(place.reach_m);
  const SE3 T_OF = place.T_FO.inverse();
  const Eigen::Matrix3f R = T_OF.R().cast<float>();
  const Eigen::Vector3f t = T_OF.t.cast<float>();
  if (!meets(b, R, t, cells, margin)) return false;
  bool any = false;
  for (int slot = 0; slot < b.count; ++slot) {
    const auto k = static_cast<std::size_t>(slot);
    if (b.seen[k] > place.left || !(b.radius[k] > 0)) continue;
    const Eigen::Vector3f point = R * Eigen::Vector3f(b.x[k], b.y[k], b.z[k]) + t;
    if (((point - cells.lower()).array() < -margin).any() ||
        ((point - cells.upper()).array() > margin).any())
      continue;
    if (!cells.has({point, R * Eigen::Vector3f(b.nx[k], b.ny[k], b.nz[k])}, margin)) continue;
    b.radius[k] = 0;
    any = true;
  }
  return any;
}

}  // namespace

std::int64_t removeShared(const SurfelMap& object, const std::vector<RestPlace>& places,
                          float stable_logit, SurfelMap& world) {
  const std::vector<Oriented> surfels = stableSurfels(object, stable_logit);
  if (surfels.empty() || places.empty()) return 0;
  const Cells cells(surfels);
  const std::int64_t before = world.size();
  for (int i = 0; i < world.blocks(); ++i) {
    SurfelBlock& b = world.block(i);
    bool any = false;
    for (const RestPlace& place : places) {
      if (b.count > 0 && markShared(cells, place, b)) any = true;
    }
    if (any) world.compact(i);
  }
  return before - world.size();
}

}  // namespace rf
