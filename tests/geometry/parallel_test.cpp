// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/parallel.hpp"

#include <array>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace rf {
namespace {

class Parallel : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { setThreads(GetParam()); }
  void TearDown() override { setThreads(1); }
};

TEST_P(Parallel, EveryChunkAndEveryRowRunsOnce) {
  std::vector<int> chunks(1000, 0);
  parallelChunks(1000, [&](int i) { ++chunks[i]; });
  EXPECT_EQ(chunks, std::vector<int>(1000, 1));
  std::vector<int> rows(241, 0);
  parallelRows(241, [&](int v) { ++rows[v]; });
  EXPECT_EQ(rows, std::vector<int>(241, 1));
  parallelChunks(0, [](int) { FAIL(); });
}

TEST_P(Parallel, SumsDoNotDependOnTheThreads) {
  const auto harmonic = [](int chunk, double& sum) {
    for (int k = 1; k <= 100; ++k) sum += 1.0 / (100 * chunk + k);
  };
  double expected = 0;
  for (int chunk = 0; chunk < 57; ++chunk) {
    double sum = 0;
    harmonic(chunk, sum);
    expected += sum;
  }
  EXPECT_EQ(reduceChunks(57, 0.0, harmonic), expected);
}

TEST_P(Parallel, CallsMayRunLoopsOfTheirOwn) {
  std::array<std::vector<int>, 3> rows;
  const auto fill = [](std::vector<int>& out, int height) {
    out.assign(height, 0);
    parallelRows(height, [&](int v) { out[v] = v + 1; });
  };
  parallelCalls({[&] { fill(rows[0], 200); }, [&] { fill(rows[1], 1); },
                 [&] {
                   parallelCalls({[&] { fill(rows[2], 77); }, [] {}});
                 }});
  const std::array<int, 3> heights = {200, 1, 77};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    ASSERT_EQ(rows[k].size(), static_cast<std::size_t>(heights[k]));
    for (int v = 0; v < heights[k]; ++v) EXPECT_EQ(rows[k][v], v + 1);
  }
}

TEST_P(Parallel, ExceptionsReachTheCaller) {
  EXPECT_THROW(parallelCalls({[] {}, [] { throw std::runtime_error("one of them"); }}),
               std::runtime_error);
  EXPECT_THROW(parallelChunks(8,
                              [](int i) {
                                if (i == 5) throw std::out_of_range("five");
                              }),
               std::out_of_range);
}

INSTANTIATE_TEST_SUITE_P(Threads, Parallel, testing::Values(1, 2, 5));

TEST(Threads, AtLeastOne) {
  EXPECT_THROW(setThreads(0), std::invalid_argument);
  EXPECT_EQ(threads(), 1);
}

}  // namespace
}  // namespace rf
