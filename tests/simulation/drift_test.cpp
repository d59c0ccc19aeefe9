// SPDX-License-Identifier: BSD-3-Clause
#include "priors/drift.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "simulation/simulator.hpp"

namespace rf {
namespace {

constexpr double kPaperMps = 0.06;
constexpr double kPaperRadps = 0.4;

/// 15 s of plane-parallel motion at 15 to 45 cm/s with a slow turn, `hz` poses a second.
std::vector<DriftPose> path(double seconds, double hz) {
  std::vector<DriftPose> out;
  SE3 pose;
  const int n = static_cast<int>(seconds * hz) + 1;
  for (int k = 0; k < n; ++k) {
    const double t = k / hz;
    out.emplace_back(std::llround(t * 1e6), pose);
    Vec6 twist = Vec6::Zero();
    twist[0] = (0.3 + 0.15 * std::sin(0.7 * t)) / hz;
    twist[5] = 0.2 * std::sin(0.4 * t) / hz;
    pose = pose * SE3::exp(twist);
  }
  return out;
}

double meanAte(const std::vector<DriftPose>& truth, const std::vector<DriftPose>& drifted) {
  double sum = 0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    sum += (truth[k].second.t - drifted[k].second.t).squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(truth.size()));
}

double rpeOneSecond(const std::vector<DriftPose>& truth, const std::vector<DriftPose>& drifted,
                    std::size_t step) {
  double sum = 0;
  std::size_t n = 0;
  for (std::size_t k = 0; k + step < truth.size(); ++k, ++n) {
    const SE3 a = truth[k].second.inverse() * truth[k + step].second;
    const SE3 b = drifted[k].second.inverse() * drifted[k + step].second;
    sum += (a.inverse() * b).t.squaredNorm();
  }
  return std::sqrt(sum / static_cast<double>(n));
}

DriftSpec paper(std::uint64_t seed) { return {kPaperMps, kPaperRadps, seed, DriftStream::kCamera}; }

TEST(Drift, MeanNormsAreTheSpecified) {
  const auto truth = path(15, 30);
  const auto drifted = addDrift(truth, paper(7));
  double linear = 0;
  double angular = 0;
  for (std::size_t k = 1; k < truth.size(); ++k) {
    const SE3 a = truth[k - 1].second.inverse() * truth[k].second;
    const SE3 b = drifted[k - 1].second.inverse() * drifted[k].second;
    const Vec6 xi = (a.inverse() * b).log();
    linear += xi.head<3>().norm() / 15.0;
    angular += xi.tail<3>().norm() / 15.0;
  }
  EXPECT_NEAR(linear, kPaperMps, 1e-3);
  EXPECT_NEAR(angular, kPaperRadps, 5e-3);
}

// Over 15 s the prior must show the ATE (9 to 55 cm) and RPE (5.7 to 6.5 cm/s) of the paper's prior
// columns. Seeds scatter: every ATE is inside, the RPE of four seeds in five.
TEST(Drift, LooksLikeThePapersPriorColumns) {
  const auto truth = path(15, 30);
  std::vector<double> ate;
  std::vector<double> rpe;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto drifted = addDrift(truth, paper(seed));
    ate.push_back(meanAte(truth, drifted) * 100);
    rpe.push_back(rpeOneSecond(truth, drifted, 30) * 100);
  }
  std::sort(ate.begin(), ate.end());
  std::sort(rpe.begin(), rpe.end());
  std::printf("ATE cm: min %.1f 5%% %.1f median %.1f 95%% %.1f max %.1f\n", ate[0], ate[10],
              ate[100], ate[189], ate[199]);
  std::printf("RPE cm/s: min %.2f 10%% %.2f median %.2f 90%% %.2f max %.2f\n", rpe[0], rpe[20],
              rpe[100], rpe[179], rpe[199]);
  EXPECT_GT(ate.front(), 9.0);
  EXPECT_LT(ate.back(), 55.0);
  EXPECT_GT(rpe[20], 5.7);
  EXPECT_LT(rpe[179], 6.5);
}

// The same on the cameras of the simulated sequences, where rotation acts on another path.
TEST(Drift, FitsTheSimulatedSequences) {
  for (const char* scene : {"straight", "orbit", "overtake", "sideway"}) {
    const sim::World world = sim::buildWorld(scene, 1);
    std::vector<DriftPose> truth;
    for (int k = 0; k < world.frames; ++k) {
      truth.emplace_back(sim::Simulator::utime(k), world.camera_at(k / sim::kFrameRate));
    }
    double ate = 0;
    double rpe = 0;
    const int seeds = 60;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      const auto drifted = addDrift(truth, paper(seed));
      ate += meanAte(truth, drifted) * 100 / seeds;
      rpe += rpeOneSecond(truth, drifted, 30) * 100 / seeds;
    }
    std::printf("%-9s mean ATE %.1f cm, mean RPE %.2f cm/s\n", scene, ate, rpe);
    EXPECT_GT(ate, 9.0) << scene;
    EXPECT_LT(ate, 55.0) << scene;
    EXPECT_GT(rpe, 5.7) << scene;
    EXPECT_LT(rpe, 6.5) << scene;
  }
}

TEST(Drift, SameSeedSameBitsOtherSeedOrStreamOtherDrift) {
  const auto truth = path(3, 30);
  const auto a = addDrift(truth, paper(3));
  EXPECT_EQ(a, addDrift(truth, paper(3)));
  EXPECT_NE(a, addDrift(truth, paper(4)));
  EXPECT_NE(a, addDrift(truth, {kPaperMps, kPaperRadps, 3, DriftStream::kObject}));
  EXPECT_EQ(a.front(), truth.front());
}

TEST(Drift, ACutHasTheDriftOfTheWhole) {
  const auto truth = path(15, 30);
  const auto whole = addDrift(truth, paper(5));
  const auto cut = addDrift(std::span(truth).first(60), paper(5));
  for (std::size_t k = 0; k < cut.size(); ++k) {
    EXPECT_LT((whole[k].second.t - cut[k].second.t).norm(), 1e-12) << "pose " << k;
  }
}

TEST(Drift, DoesNotDependOnTheSamplingRate) {
  const auto slow = addDrift(path(5, 30), paper(5));
  const auto fast = addDrift(path(5, 90), paper(5));
  const double gap = (slow.back().second.t - fast.back().second.t).norm();
  EXPECT_LT(gap, 0.06) << "the drift over 5 s is some 20 cm";
  const double angle = slow.back().second.q.angularDistance(fast.back().second.q);
  EXPECT_LT(angle, 0.05);
}

TEST(Drift, ZeroRatesChangeNothing) {
  const auto truth = path(2, 30);
  const auto same = addDrift(truth, {0, 0, 1, DriftStream::kCamera});
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_LT((truth[k].second.t - same[k].second.t).norm(), 1e-12);
  }
}

TEST(Drift, RefusesBadInput) {
  auto truth = path(1, 30);
  EXPECT_THROW(addDrift(truth, {-0.1, 0, 1, DriftStream::kCamera}), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(addDrift(truth, {0, nan, 1, DriftStream::kCamera}), std::invalid_argument);
  truth[3].second.t.x() = nan;
  EXPECT_THROW(addDrift(truth, paper(1)), std::invalid_argument);
  truth = path(1, 30);
  truth[4].first = truth[3].first;
  EXPECT_THROW(addDrift(truth, paper(1)), std::invalid_argument);
  EXPECT_TRUE(addDrift({}, paper(1)).empty());
}

}  // namespace
}  // namespace rf
