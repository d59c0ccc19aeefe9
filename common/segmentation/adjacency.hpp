// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

namespace rf {

/// Symmetric boolean graph of clusters that touch in space (E_ij of the paper's S_R).
class Adjacency {
 public:
  explicit Adjacency(std::size_t count) : count_(count), edges_(count * count, 0) {}
  std::size_t count() const { return count_; }
  void join(std::size_t i, std::size_t j) {
    if (i == j) return;
    edges_[i * count_ + j] = 1;
    edges_[j * count_ + i] = 1;
  }
  bool joined(std::size_t i, std::size_t j) const { return edges_[i * count_ + j] != 0; }

 private:
  std::size_t count_;
  std::vector<unsigned char> edges_;
};

}  // namespace rf
