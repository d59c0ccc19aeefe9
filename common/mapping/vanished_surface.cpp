// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/vanished_surface.hpp"

#include <algorithm>
#include <unordered_map>

namespace rf {
namespace {

constexpr double kLargest = 0.1;  // of the cells with points

}  // namespace

std::size_t VanishedSurface::CellHash::operator()(const Cell& c) const {
  const auto u = [](std::int32_t v) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v));
  };
  return static_cast<std::size_t>((u(c[0]) * 73856093U) ^ (u(c[1]) * 19349663U) ^
                                  (u(c[2]) * 83492791U));
}

VanishedSurface::Cell VanishedSurface::cellOf(const Eigen::Vector3f& point) {
  const Eigen::Array3f c = (point.array() / kCell).floor();
  return {static_cast<std::int32_t>(c.x()), static_cast<std::int32_t>(c.y()),
          static_cast<std::int32_t>(c.z())};
}

// Cells in disjoint sets.
class VanishedSurface::Islands {
 public:
  // Number of a cell, a new one joined to the neighbours that are there.
  std::uint32_t put(const Cell& cell) {
    const auto [it, is_new] = number_.try_emplace(cell, size());
    if (is_new) {
      parent_.push_back(it->second);
      joinNeighbours(cell, it->second);
    }
    return it->second;
  }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::uint32_t size() const { return static_cast<std::uint32_t>(parent_.size()); }

 private:
  void joinNeighbours(const Cell& cell, std::uint32_t own) {
    for (int dz = -1; dz <= 1; ++dz) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
          const auto there = number_.find({cell[0] + dx, cell[1] + dy, cell[2] + dz});
          if (there != number_.end()) join(own, there->second);
        }
      }
    }
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  std::unordered_map<Cell, std::uint32_t, CellHash> number_;
  std::vector<std::uint32_t> parent_;
};

// What belongs to an island.
struct VanishedSurface::Extent {
  double there = 0, gone = 0;                 // cells
  double surfels = 0, seen = 0, gone_at = 0;  // number; sums of frames
};

void VanishedSurface::add(const Eigen::Vector3f& point, std::int32_t time) {
  const Cell cell = cellOf(point);
  const auto known = cells_.find(cell);
  if (known != cells_.end()) {
    known->second = time;
  } else if (cells_.size() < kMostCells) {
    cells_.emplace(cell, time);
  }
}

bool VanishedSurface::isRemnant(const Extent& e, double all_there) {
  if (e.gone <= e.there || e.there > kLargest * all_there) return false;
  return e.seen / e.surfels < e.gone_at / e.gone + kSettled;
}

std::vector<std::uint8_t> VanishedSurface::remnants(const std::vector<Surfel>& surfels) const {
  std::vector<std::uint8_t> remnant(surfels.size(), 0);
  if (cells_.empty()) return remnant;
  Islands islands;
  std::vector<std::uint32_t> island(surfels.size());
  for (std::size_t i = 0; i < surfels.size(); ++i)
    island[i] = islands.put(cellOf(surfels[i].point));
  const std::uint32_t there = islands.size();
  for (const auto& [cell, time] : cells_) islands.put(cell);
  std::vector<Extent> extents(islands.size());
  for (std::uint32_t i = 0; i < there; ++i) extents[islands.root(i)].there += 1;
  for (const auto& [cell, time] : cells_) {
    const std::uint32_t i = islands.put(cell);
    if (i < there) continue;
    Extent& e = extents[islands.root(i)];
    e.gone += 1;
    e.gone_at += time;
  }
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    island[i] = islands.root(island[i]);
    extents[island[i]].surfels += 1;
    extents[island[i]].seen += surfels[i].seen;
  }
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    remnant[i] = isRemnant(extents[island[i]], there) ? 1 : 0;
  }
  return remnant;
}

}  // namespace rf
