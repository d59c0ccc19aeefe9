// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/parallel.hpp"

#include <stdexcept>
#include <string>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace rf {
namespace {
int g_threads = 1;  // process-wide by design: one pool, set once by main

tbb::task_arena& arena() {
  static tbb::task_arena instance(g_threads);
  return instance;
}
}  // namespace

void setThreads(int threads) {
  if (threads < 1)
    throw std::invalid_argument("threads = " + std::to_string(threads) + ": must be >= 1");
  g_threads = threads;
  arena().terminate();
  arena().initialize(threads);
}

int threads() { return g_threads; }

void parallelChunks(int chunks, const std::function<void(int)>& body) {
  if (g_threads == 1 || chunks <= 1) {
    for (int i = 0; i < chunks; ++i) body(i);
    return;
  }
  arena().execute([&] {
    tbb::parallel_for(
        0, chunks, [&](int i) { body(i); }, tbb::simple_partitioner());
  });
}

void parallelCalls(std::initializer_list<std::function<void()>> calls) {
  parallelChunks(static_cast<int>(calls.size()), [&](int i) { calls.begin()[i](); });
}

}  // namespace rf
