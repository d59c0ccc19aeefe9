// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <vector>

namespace rf {

/// Sets the number of worker threads of this process (>= 1). Call it once from main.
void setThreads(int threads);
int threads();

/// Runs body(chunk) for chunk = 0..chunks-1, possibly in parallel. The split into chunks is the
/// CALLER's and must not depend on the thread count: that is what makes 1 and N threads give the
/// same bits. Exceptions propagate.
void parallelChunks(int chunks, const std::function<void(int)>& body);

/// Runs the calls, possibly in parallel. None may depend on another, nor on which thread it runs;
/// each may run parallel loops of its own.
void parallelCalls(std::initializer_list<std::function<void()>> calls);

/// Runs body(v) for every row v = 0..height-1, possibly in parallel. No row may depend on another.
template <typename Body>
void parallelRows(int height, const Body& body) {
  constexpr int kRows = 16;  // a chunk
  parallelChunks((height + kRows - 1) / kRows, [&](int chunk) {
    const int end = std::min(height, (chunk + 1) * kRows);
    for (int v = chunk * kRows; v < end; ++v) body(v);
  });
}

/// Deterministic reduction: `partial` values are computed per chunk, possibly in parallel, and
/// added in chunk order.
template <typename Sum, typename Body>
Sum reduceChunks(int chunks, const Sum& zero, const Body& body) {
  std::vector<Sum> partial(static_cast<std::size_t>(chunks), zero);
  parallelChunks(chunks, [&](int i) { body(i, partial[static_cast<std::size_t>(i)]); });
  Sum total = zero;
  for (const Sum& p : partial) total += p;
  return total;
}

}  // namespace rf
