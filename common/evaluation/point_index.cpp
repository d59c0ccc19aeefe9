// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/point_index.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rf {

struct PointIndex::Search {
  const Eigen::Vector3f& query;
  float best_squared;
  std::optional<std::uint32_t> best;
};

PointIndex::PointIndex(std::vector<Eigen::Vector3f> points)
    : points_(std::move(points)), order_(points_.size()), axis_(points_.size(), 0) {
  std::iota(order_.begin(), order_.end(), 0U);
  build(0, order_.size());
}

void PointIndex::build(std::size_t begin, std::size_t end) {
  if (end - begin < 2) return;
  Eigen::Vector3f low = points_[order_[begin]];
  Eigen::Vector3f high = low;
  for (std::size_t i = begin; i < end; ++i) {
    low = low.cwiseMin(points_[order_[i]]);
    high = high.cwiseMax(points_[order_[i]]);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
    const float x = points_[a][axis];
    const float y = points_[b][axis];
    return x != y ? x < y : a < b;
  });
  axis_[middle] = static_cast<std::uint8_t>(axis);
  build(begin, middle);
  build(middle + 1, end);
}

void PointIndex::visit(std::size_t begin, std::size_t end, Search& search) const {
  if (begin >= end) return;
  const std::size_t middle = begin + (end - begin) / 2;
  const Eigen::Vector3f& point = points_[order_[middle]];
  const float squared = (point - search.query).squaredNorm();
  if (squared <= search.best_squared) {
    search.best_squared = squared;
    search.best = order_[middle];
  }
  if (end - begin == 1) return;
  const float offset = search.query[axis_[middle]] - point[axis_[middle]];
  const bool left_first = offset < 0;
  left_first ? visit(begin, middle, search) : visit(middle + 1, end, search);
  if (offset * offset > search.best_squared) return;
  left_first ? visit(middle + 1, end, search) : visit(begin, middle, search);
}

std::optional<PointIndex::Neighbour> PointIndex::nearest(const Eigen::Vector3f& query,
                                                         float max_distance) const {
  Search search{query, max_distance * max_distance, std::nullopt};
  visit(0, order_.size(), search);
  if (!search.best) return std::nullopt;
  return Neighbour{*search.best, std::sqrt(search.best_squared)};
}

}  // namespace rf
