// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "mapping/surfel_map.hpp"

namespace rf {

/// Where a model had surface that is not there any more: cubic cells of its frame. It tells what is
/// left of a thing that has gone: a person who sat still is part of the static map; when he gets
/// up, what was in view of him is removed, and what was not - a lap below the image - would stay.
class VanishedSurface {
 public:
  /// Notes that a surfel at `point` (metres, the model's frame) was removed in frame `time`. Beyond
  /// kMostCells cells nothing is noted.
  void add(const Eigen::Vector3f& point, std::int32_t time);

  /// Which surfels (1) are a remnant. Surfels and vanished surface make islands: cells that touch
  /// by a face, an edge or a corner belong together. An island is a remnant when more of its cells
  /// have vanished than are there, unless it has more than a tenth of all cells that are there (a
  /// world does not go) or was still measured kSettled frames after the rest of it had gone (a
  /// chair that somebody left stands by itself), both on average.
  std::vector<std::uint8_t> remnants(const std::vector<Surfel>& surfels) const;

  std::size_t cells() const { return cells_.size(); }

  static constexpr float kCell = 0.03F;         ///< metres, a few surfels at two metres
  static constexpr std::int32_t kSettled = 30;  ///< frames: a second
  static constexpr std::size_t kMostCells = 1'000'000;

 private:
  using Cell = std::array<std::int32_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& c) const;
  };
  class Islands;
  struct Extent;
  static bool isRemnant(const Extent& extent, double all_there);
  static Cell cellOf(const Eigen::Vector3f& point);

  std::unordered_map<Cell, std::int32_t, CellHash> cells_;  ///< and the frame it went in
};

}  // namespace rf
