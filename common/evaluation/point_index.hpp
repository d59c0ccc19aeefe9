// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace rf {

/// Nearest neighbours in a fixed cloud (a balanced k-d tree without pointers). Queries are const
/// and thread-safe.
class PointIndex {
 public:
  /// Coordinates in metres, finite.
  explicit PointIndex(std::vector<Eigen::Vector3f> points);

  struct Neighbour {
    std::uint32_t index = 0;  ///< into the cloud as given
    float distance = 0;       ///< metres
  };
  /// The nearest point at most `max_distance` away; among equals any one, always the same.
  std::optional<Neighbour> nearest(const Eigen::Vector3f& query, float max_distance) const;

  std::size_t size() const { return order_.size(); }

 private:
  struct Search;
  void build(std::size_t begin, std::size_t end);
  void visit(std::size_t begin, std::size_t end, Search& search) const;

  std::vector<Eigen::Vector3f> points_;
  std::vector<std::uint32_t> order_;  ///< in-order layout of the tree: the middle splits
  std::vector<std::uint8_t> axis_;    ///< split axis of each middle
};

}  // namespace rf
