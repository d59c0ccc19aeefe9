// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/map_correction.hpp"

#include <cstddef>
#include <optional>

#include "geometry/parallel.hpp"
#include "mapping/map_uncertainty.hpp"

namespace rf {
namespace {

struct Move {
  Eigen::Matrix3f R;
  Eigen::Vector3f t;
};

std::vector<std::optional<Move>> movesOf(const std::vector<Vec6>& twists) {
  std::vector<std::optional<Move>> moves(twists.size());
  for (std::size_t i = 0; i < twists.size(); ++i) {
    if (twists[i].isZero()) continue;
    const SE3 T = SE3::exp(twists[i]);
    moves[i] = Move{T.R().cast<float>(), T.t.cast<float>()};
  }
  return moves;
}

void moveBlock(const std::vector<std::optional<Move>>& moves, SurfelBlock& b) {
  for (int i = 0; i < b.count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const std::size_t epoch = MapUncertainty::epochOf(b.born[k]);
    if (epoch >= moves.size() || !moves[epoch]) continue;
    const Move& move = *moves[epoch];
    const Eigen::Vector3f p = move.R * Eigen::Vector3f(b.x[k], b.y[k], b.z[k]) + move.t;
    const Eigen::Vector3f n = move.R * Eigen::Vector3f(b.nx[k], b.ny[k], b.nz[k]);
    b.x[k] = p.x();
    b.y[k] = p.y();
    b.z[k] = p.z();
    b.nx[k] = n.x();
    b.ny[k] = n.y();
    b.nz[k] = n.z();
    b.cover(i);
  }
}

}  // namespace

void moveByBirth(const std::vector<Vec6>& twists, SurfelMap& map) {
  const std::vector<std::optional<Move>> moves = movesOf(twists);
  parallelChunks(map.blocks(), [&](int block) { moveBlock(moves, map.block(block)); });
}

}  // namespace rf
