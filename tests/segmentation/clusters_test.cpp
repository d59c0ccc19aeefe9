// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/clusters.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "values/segmentation_result.hpp"

namespace rf {
namespace {

Camera testCamera(int width, int height) {
  Camera c;
  c.width = width;
  c.height = height;
  c.fx = 0.82 * width;
  c.fy = 0.83 * width;
  c.cx = 0.5 * width;
  c.cy = 0.5 * height;
  return c;
}

RgbdLevel flatLevel(int width, int height, float depth) {
  return {testCamera(width, height), Image<float>(width, height, 0.5F),
          Image<float>(width, height, depth)};
}

/// A box in front of a wall, with noise and holes.
RgbdLevel boxAndWall(int width, int height, unsigned seed) {
  std::mt19937_64 random(seed);
  RgbdLevel level = flatLevel(width, height, 3.0F);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const auto bits = random();
      const bool box = u > width / 3 && u < width / 2 && v > height / 4 && v < 3 * height / 4;
      level.depth(u, v) = (box ? 1.2F : 3.0F) + 1e-4F * static_cast<float>(bits % 64);
      if (bits >> 60 == 0) level.depth(u, v) = 0;
    }
  }
  return level;
}

TEST(Clusters, LabelsAreNearestCentresOnEveryLevel) {
  const auto pyramid = buildPyramid(boxAndWall(160, 120, 3), 3);
  const Clusters c = clusterFrame(pyramid, {});
  ASSERT_EQ(c.centres.size(), static_cast<std::size_t>(ClusterParams{}.count));
  ASSERT_EQ(c.label.size(), 3u);
  for (std::size_t l = 0; l < 3; ++l) {
    const RgbdLevel& level = pyramid[l];
    for (int v = 0; v < level.camera.height; ++v) {
      for (int u = 0; u < level.camera.width; ++u) {
        const float z = level.depth(u, v);
        if (!(z > 0)) {
          ASSERT_EQ(c.label[l](u, v), kNoCluster);
          continue;
        }
        const Eigen::Vector3f p =
            level.camera.backProject(u, v, static_cast<double>(z)).cast<float>();
        ASSERT_LT(c.label[l](u, v), c.centres.size());
        const float chosen = (p - c.centres[c.label[l](u, v)]).norm();
        for (const Eigen::Vector3f& centre : c.centres) {
          ASSERT_LE(chosen, (p - centre).norm() + 1e-5F);
        }
      }
    }
  }
}

TEST(Clusters, SeparatesSurfacesAndJoinsWhatTouches) {
  const auto pyramid = buildPyramid(boxAndWall(320, 240, 5), 2);
  const Clusters c = clusterFrame(pyramid, {});
  std::size_t joined = 0;
  for (std::size_t i = 0; i < c.centres.size(); ++i) {
    EXPECT_FALSE(c.adjacency.joined(i, i));
    for (std::size_t j = 0; j < c.centres.size(); ++j) {
      EXPECT_EQ(c.adjacency.joined(i, j), c.adjacency.joined(j, i));
      if (!c.adjacency.joined(i, j)) continue;
      ++joined;
      // Box and wall are 1.8 m apart: no edge may cross.
      EXPECT_LT(std::abs(c.centres[i].z() - c.centres[j].z()), 0.5F);
    }
  }
  EXPECT_GT(joined, c.centres.size());
}

TEST(Clusters, WorksWithoutAnythingToCluster) {
  EXPECT_TRUE(clusterFrame({}, {}).centres.empty());
  const RgbdLevel empty{testCamera(0, 0), {}, {}};
  EXPECT_TRUE(clusterFrame({empty}, {}).centres.empty());
  const Clusters none = clusterFrame({flatLevel(40, 30, 0.0F), flatLevel(20, 15, 0.0F)}, {});
  EXPECT_TRUE(none.centres.empty());
  EXPECT_EQ(none.adjacency.count(), 0u);
  ASSERT_EQ(none.label.size(), 2u);
  for (std::uint8_t l : none.label[0]) ASSERT_EQ(l, kNoCluster);
}

TEST(Clusters, FewerPointsThanClusters) {
  RgbdLevel level = flatLevel(40, 30, 0.0F);
  level.depth(3, 4) = 1.0F;
  level.depth(30, 20) = 2.0F;
  level.depth(20, 10) = 1.5F;
  const Clusters c = clusterFrame({level}, {});
  EXPECT_GE(c.centres.size(), 1u);
  EXPECT_LE(c.centres.size(), 3u);
  EXPECT_EQ(c.sizes.size(), c.centres.size());
  EXPECT_LT(c.label[0](3, 4), c.centres.size());
  EXPECT_EQ(c.label[0](0, 0), kNoCluster);
}

TEST(Clusters, OddSizesAndManyClusters) {
  ClusterParams params;
  params.count = 250;
  const Clusters c = clusterFrame({boxAndWall(321, 61, 9)}, params);
  EXPECT_GT(c.centres.size(), 200u);
  for (const Eigen::Vector3f& centre : c.centres) EXPECT_TRUE(centre.allFinite());
}

TEST(Clusters, SameBitsForEveryThreadCount) {
  const auto pyramid = buildPyramid(boxAndWall(320, 240, 11), 3);
  setThreads(1);
  const Clusters one = clusterFrame(pyramid, {});
  setThreads(2);
  const Clusters two = clusterFrame(pyramid, {});
  setThreads(1);
  ASSERT_EQ(one.centres.size(), two.centres.size());
  for (std::size_t k = 0; k < one.centres.size(); ++k) EXPECT_EQ(one.centres[k], two.centres[k]);
  for (std::size_t l = 0; l < 3; ++l) EXPECT_TRUE(one.label[l] == two.label[l]);
  EXPECT_EQ(one.sizes, two.sizes);
}

}  // namespace
}  // namespace rf
