// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "simulation/surface_samples.hpp"

namespace rf::sim {
namespace {

bool sameBytes(const SimulatedFrame& a, const SimulatedFrame& b) {
  return a.colour == b.colour && a.depth == b.depth && a.mask == b.mask;
}

TEST(Simulator, SameSeedSameBytesForAnyThreadCount) {
  const Simulator first("sideway", 21);
  const SimulatedFrame frame = first.frame(80);
  EXPECT_TRUE(sameBytes(frame, first.frame(80)));
  setThreads(3);
  const Simulator again("sideway", 21);
  EXPECT_TRUE(sameBytes(frame, again.frame(80)));
  setThreads(1);
  const Simulator other("sideway", 22);
  const SimulatedFrame different = other.frame(80);
  EXPECT_NE(frame.colour, different.colour);
  EXPECT_NE(frame.depth, different.depth);
  EXPECT_EQ(frame.T_WC, different.T_WC) << "the seed does not change the choreography";
  EXPECT_NE(frame.colour, Simulator("sideway", 21, 2.0).frame(80).colour);
  EXPECT_THROW(Simulator("sideway", 21, -1.0), std::invalid_argument);
}

/// Lifts the pixels of frame a that show `body`, moves them with the true poses into frame b, and
/// compares with b's depth. Returns |difference| over the sensor's sigma, sorted; occluded points
/// (b sees something well in front) are left out.
std::vector<double> reprojectionErrors(const Simulator& simulator, const SimulatedFrame& a,
                                       const SimulatedFrame& b, std::size_t body) {
  const Camera& c = simulator.world().camera;
  const SE3 T_CbCa = b.T_WC.inverse() * b.T_WB[body] * a.T_WB[body].inverse() * a.T_WC;
  const std::uint8_t label = body == 0 ? 1 : 2;
  std::vector<double> errors;
  for (int v = 0; v < c.height; v += 3) {
    for (int u = 0; u < c.width; u += 3) {
      if (a.mask(u, v) != label) continue;
      const Vec3 p = T_CbCa * c.backProject(u, v, a.depth(u, v) / kDepthFactor);
      const Eigen::Vector2d at = c.project(p);
      const int i = static_cast<int>(std::lround(at.x()));
      const int j = static_cast<int>(std::lround(at.y()));
      if (!b.depth.inside(i, j) || b.mask(i, j) != label) continue;
      const double seen = b.depth(i, j) / kDepthFactor;
      if (std::abs(seen - p.z()) > 0.25) continue;
      errors.push_back(std::abs(seen - p.z()) / (std::sqrt(2.0) * depthSigma(p.z())));
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

TEST(Simulator, TruePosesAlignTheDepthOfBothBodies) {
  const Simulator simulator("sideway", 5);
  const SimulatedFrame a = simulator.frame(90);
  const SimulatedFrame b = simulator.frame(105);
  ASSERT_GT((a.T_WB[1].t - b.T_WB[1].t).norm(), 0.05) << "the object moves";
  for (const std::size_t body : {0U, 1U}) {
    const std::vector<double> errors = reprojectionErrors(simulator, a, b, body);
    ASSERT_GT(errors.size(), 2000U);
    const double median = errors[errors.size() / 2];
    std::printf("body %zu: %zu points, median error %.2f sigma, 90 %% %.2f\n", body, errors.size(),
                median, errors[errors.size() * 9 / 10]);
    // A normal error has its median at 0.67 sigma; slanted surfaces and nearest pixels add some.
    EXPECT_LT(median, 1.2);
    EXPECT_LT(errors[errors.size() * 9 / 10], 4.0);
  }
}

TEST(Simulator, PicturesAreExposedAndTextured) {
  const Simulator simulator("orbit", 8);
  const SimulatedFrame frame = simulator.frame(30);
  double sum = 0;
  double gradient = 0;
  int valid = 0;
  for (int v = 0; v < 480; ++v) {
    for (int u = 1; u < 640; ++u) {
      sum += frame.colour(u, v).g;
      gradient += std::abs(int{frame.colour(u, v).g} - int{frame.colour(u - 1, v).g});
      valid += frame.depth(u, v) > 0 ? 1 : 0;
    }
  }
  const double n = 480.0 * 639.0;
  std::printf("mean %.1f, gradient %.2f, valid %.3f\n", sum / n, gradient / n, valid / n);
  EXPECT_GT(sum / n, 80);
  EXPECT_LT(sum / n, 200);
  EXPECT_GT(gradient / n, 3.0);
  EXPECT_GT(valid / n, 0.6);
}

TEST(Simulator, SurfaceSamplesLieOnWhatIsSeen) {
  const Simulator simulator("held", 2);
  SurfaceSamples samples(simulator.world(), 0.03, 0.01);
  const SimulatedFrame frame = simulator.frame(0);
  samples.see(frame);
  const SE3 T_CW = frame.T_WC.inverse();
  const auto room = samples.seen(0, 1);
  const auto object = samples.seen(1, 1);
  ASSERT_GT(room.size(), 1000U);
  ASSERT_GT(object.size(), 200U);
  for (const SurfacePoint& point : room) {
    const Vec3 p = T_CW * point.position.cast<double>();
    EXPECT_GT(p.z(), 0.0);
    EXPECT_LT(p.z(), 5.1);
    EXPECT_LT((T_CW.R() * point.normal.cast<double>()).dot(p), 0.0) << "faces the camera";
  }
  EXPECT_TRUE(samples.seen(0, 2).empty());
}

TEST(Simulator, TimesAreThirtyHertzMicroseconds) {
  EXPECT_EQ(Simulator::utime(0), kStartUtime);
  EXPECT_EQ(Simulator::utime(30), kStartUtime + 1'000'000);
  EXPECT_EQ(Simulator::utime(1), kStartUtime + 33'333);
  EXPECT_EQ(Simulator::utime(2), kStartUtime + 66'667);
}

}  // namespace
}  // namespace rf::sim
