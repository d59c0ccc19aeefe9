// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "geometry/se3.hpp"

namespace rf {

inline constexpr int kBlockSize = 256;
/// "No surfel" in an id map.
inline constexpr std::uint32_t kNoSurfel = 0xFFFFFFFFU;

/// One disc of surface in its body's frame F.
struct Surfel {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();   ///< centre, metres
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, towards the observer
  float radius = 0;                                  ///< metres; <= 0 marks a removed surfel
  float logit = 0;                                   ///< log-odds of confidence
  float weight = 0;                                  ///< accumulated averaging weight
  Eigen::Vector3f colour = Eigen::Vector3f::Zero();  ///< red, green, blue, 0..255
  std::int32_t born = 0;                             ///< frame counter at creation
  std::int32_t seen = 0;  ///< frame counter of the last measurement it took
};

/// The surfel in another frame: T maps its body's frame to that one.
Surfel moved(Surfel s, const SE3& T);

/// Up to kBlockSize surfels of one map cell, one array per attribute. Slots from `count` on have
/// radius 0 and are never drawn.
struct alignas(64) SurfelBlock {
  using Floats = std::array<float, kBlockSize>;
  using Ints = std::array<std::int32_t, kBlockSize>;
  Floats x{}, y{}, z{}, nx{}, ny{}, nz{}, radius{}, logit{}, weight{}, red{}, green{}, blue{};
  Ints born{}, seen{};
  int count = 0;
  Eigen::Vector3f lower = Eigen::Vector3f::Zero();  ///< box of all centres ever put here
  Eigen::Vector3f upper = Eigen::Vector3f::Zero();
  float max_radius = 0;

  Surfel get(int slot) const;
  void set(int slot, const Surfel& s);
  /// Grows the box (and max_radius) over slot.
  void cover(int slot);
};

/// Surfels of one body in blocks of hashed cubic cells, in that body's frame. Ids are
/// block * kBlockSize + slot and stay valid until compact() of that block. Every operation is
/// deterministic: blocks are numbered in order of creation and only looked up by hash. A surfel
/// that wanders out of its cell stays in its block; the block's box grows.
class SurfelMap {
 public:
  explicit SurfelMap(double cell_m = 0.25, std::int64_t max_surfels = 8'000'000);

  /// Adds a surfel; kNoSurfel when the map is full or the point is not finite (or beyond 1e5
  /// cells).
  std::uint32_t append(const Surfel& surfel);

  int blocks() const { return static_cast<int>(blocks_.size()); }
  SurfelBlock& block(int i) { return *blocks_[static_cast<std::size_t>(i)]; }
  const SurfelBlock& block(int i) const { return *blocks_[static_cast<std::size_t>(i)]; }
  Surfel get(std::uint32_t id) const {
    return block(static_cast<int>(id / kBlockSize)).get(static_cast<int>(id % kBlockSize));
  }

  /// Drops the slots with radius <= 0, keeping order; renews the box. Ids of this block change.
  void compact(int block);

  std::int64_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

 private:
  struct Cell {
    std::int32_t x = 0, y = 0, z = 0;
    bool operator==(const Cell&) const = default;
  };
  struct CellHash {
    std::size_t operator()(const Cell& c) const {
      const auto u = [](std::int32_t v) {
        return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v));
      };
      return static_cast<std::size_t>((u(c.x) * 73856093U) ^ (u(c.y) * 19349663U) ^
                                      (u(c.z) * 83492791U));
    }
  };

  double cell_m_;
  std::int64_t max_surfels_;
  std::int64_t size_ = 0;
  std::vector<std::unique_ptr<SurfelBlock>> blocks_;
  std::unordered_map<Cell, std::vector<int>, CellHash> cells_;
};

}  // namespace rf
