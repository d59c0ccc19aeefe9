// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "geometry/image.hpp"
#include "geometry/pyramid.hpp"
#include "segmentation/adjacency.hpp"

namespace rf {

/// K-means over-segmentation (paper section III, algorithm A.2).
struct ClusterParams {
  int count = 96;             ///< K; the paper's 24 are too coarse for small and far objects
  int iterations = 9;         ///< Lloyd iterations at most
  double tolerance_m = 0.01;  ///< stop when no centre coordinate moves more
  double contact_m = 0.015;   ///< neighbouring pixels closer than this join clusters, at 240 rows

  template <class V>
  void visit(V& v) {
    v("count", count, 1, 250, "-", "clusters a frame (K)");
    v("iterations", iterations, 1, 100, "-", "Lloyd iterations at most");
    v("tolerance_m", tolerance_m, 1e-6, 1.0, "m",
      "largest movement of a centre that counts as settled");
    v("contact_m", contact_m, 1e-4, 1.0, "m",
      "depth step below which neighbours touch, at 240 rows");
  }
};

/// Clusters of one frame. Every centre owns at least one pixel of the clustering level.
struct Clusters {
  std::vector<Eigen::Vector3f> centres;    ///< metres, camera frame; may be fewer than K, or none
  std::vector<Image<std::uint8_t>> label;  ///< per pyramid level; kNoCluster = no depth
  std::vector<int> sizes;                  ///< pixels at the clustering level
  Adjacency adjacency{0};                  ///< surfaces in contact at the finest level
};

/// K-means on 3-D points (metres, unweighted) at the level below the finest (the finest if it is
/// the only one); labels of every level are the nearest centres. Seeds lie on a fixed grid and
/// start at the median depth of their image region; clusters that lose all points are removed.
/// Deterministic for every thread count. Works on empty and depthless images (no clusters then).
Clusters clusterFrame(const std::vector<RgbdLevel>& pyramid, const ClusterParams& params);

}  // namespace rf
