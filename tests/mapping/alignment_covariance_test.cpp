// SPDX-License-Identifier: BSD-3-Clause
#include "mapping/alignment_covariance.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "analytic_scene.hpp"
#include "geometry/pyramid.hpp"
#include "mapping/body_model.hpp"
#include "mapping/tracker.hpp"

namespace rf {
namespace {

constexpr double kFocal = 260.0;
const Mat6 kNoPrior = Mat6::Identity() * 1e-9;

AlignmentBlock block(const Mat6& H, const Vec6& gradient, double depth) {
  AlignmentBlock b;
  b.depth = depth;
  std::size_t at = 0;
  for (int r = 0; r < 6; ++r) {
    b.sums.b[static_cast<std::size_t>(r)] = gradient(r);
    for (int c = r; c < 6; ++c) b.sums.H[at++] = H(r, c);
  }
  return b;
}

TEST(AlignmentCovariance, EqualBlocksAverageTheirCommonErrors) {
  const SensorModel sensor{SensorConfig()};
  const double depth = 2.0;
  const double across = CommonError::kPhase * depth / kFocal;
  const double sigma = static_cast<double>(sensor.sigma(2.0F));
  const double along = CommonError::kDepthShare * sigma;
  const double nearer = CommonError::kNearerShare * sigma;
  const double h = 1e7;
  for (const int n : {1, 4, 48}) {
    const std::vector<AlignmentBlock> blocks(static_cast<std::size_t>(n),
                                             block(h * Mat6::Identity(), Vec6::Zero(), depth));
    const Mat6 P = alignmentCovariance(blocks, {kNoPrior, 10.0, kFocal, sensor});
    EXPECT_NEAR(P(0, 0), across * across / n + 10.0 / (n * h), 1e-12) << n;
    EXPECT_NEAR(P(2, 2), along * along / n + nearer * nearer + 10.0 / (n * h), 1e-12)
        << n << ": the bias of all blocks does not average out";
    EXPECT_NEAR(P(4, 4), 10.0 / (n * h), 1e-12) << n;
  }
}

TEST(AlignmentCovariance, ResidualsThatAreTooLargeCount) {
  const std::vector<AlignmentBlock> blocks(48, block(1e7 * Mat6::Identity(), Vec6::Zero(), 2.0));
  AlignmentNoise noise{kNoPrior, 10.0, kFocal, SensorModel{SensorConfig()}};
  const Mat6 once = alignmentCovariance(blocks, noise);
  noise.factor = 2.0;
  const Mat6 twice = alignmentCovariance(blocks, noise);
  EXPECT_NEAR(twice(2, 2) / once(2, 2), 4.0, 1e-6);
  EXPECT_NEAR(twice(5, 5) / once(5, 5), 4.0, 1e-6);
}

TEST(AlignmentCovariance, ThePriorIsWhatIsLeftWithoutBlocks) {
  Mat6 prior = Mat6::Identity() * 4.0;
  prior(0, 0) = 100.0;
  const Mat6 P = alignmentCovariance({}, {prior, 10.0, kFocal, SensorModel{SensorConfig()}});
  EXPECT_LT((P - prior.inverse()).norm(), 1e-12);
}

// Least squares with residuals that are alike within a block: the estimate scatters as it says,
// however many pixels a block has.
TEST(AlignmentCovariance, CorrelatedPixelsDoNotPretendToBeMany) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  constexpr int kBlocks = 40, kPixels = 60, kDraws = 300;
  SensorConfig exact;  // no common error that leaves no residual
  exact.sigma_base_m = 0;
  exact.sigma_growth = 0;
  std::vector<std::vector<Vec6>> J(kBlocks);
  for (auto& rows : J) {
    Vec6 common;
    for (int k = 0; k < 6; ++k) common(k) = normal(random);
    for (int i = 0; i < kPixels; ++i) {
      Vec6 own;
      for (int k = 0; k < 6; ++k) own(k) = normal(random);
      rows.push_back(common + 0.3 * own);
    }
  }
  Mat6 scatter = Mat6::Zero(), claimed = Mat6::Zero();
  double nees = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    std::vector<Mat6> H(kBlocks, Mat6::Zero());
    std::vector<double> common(kBlocks);
    Mat6 total = Mat6::Zero();
    Vec6 right = Vec6::Zero();
    for (int b = 0; b < kBlocks; ++b) {
      common[static_cast<std::size_t>(b)] = normal(random);
      for (const Vec6& j : J[static_cast<std::size_t>(b)]) {
        H[static_cast<std::size_t>(b)] += j * j.transpose();
        right += j * common[static_cast<std::size_t>(b)];
      }
      total += H[static_cast<std::size_t>(b)];
    }
    const Vec6 x = total.ldlt().solve(right);
    std::vector<AlignmentBlock> blocks;
    for (int b = 0; b < kBlocks; ++b) {
      const auto k = static_cast<std::size_t>(b);
      Vec6 gradient = -H[k] * x;
      for (const Vec6& j : J[k]) gradient += j * common[k];
      blocks.push_back(block(H[k], gradient, 0.0));
    }
    const Mat6 P = alignmentCovariance(blocks, {kNoPrior, 1.0, kFocal, SensorModel{exact}});
    scatter += x * x.transpose() / kDraws;
    claimed += P / kDraws;
    nees += x.dot(P.ldlt().solve(x)) / 6.0 / kDraws;
  }
  EXPECT_NEAR(claimed.trace() / scatter.trace(), 1.0, 0.3);
  EXPECT_GT(nees, 0.7);
  EXPECT_LT(nees, 1.6)
      << "the covariance is itself an estimate from 40 blocks: Hotelling gives 1.2";
}

// The whole tracker against frames with the sensor's noise.
TEST(AlignmentCovariance, AlignedPosesAreNotWorseThanTheySay) {
  const FusionConfig config;
  const Camera full = test::testCamera();
  const SE3 T_WP(Mat3::Identity(), Vec3(0, 0, -1.2));
  const auto look = [&](const SE3& T_WC, std::uint64_t seed) {
    const test::Shot shot = test::shoot(test::room(), T_WC, full, {1.0, 2.0, seed}, 0);
    return reduceFrame(shot.frame.colour, shot.frame.depth_mm, full, 2, 0.3, 6.0);
  };
  const auto maps = [&](const RgbdLevel& l) {
    Image<Rgb> colour(l.depth.width(), l.depth.height());
    for (std::size_t i = 0; i < colour.size(); ++i) {
      const auto grey = static_cast<std::uint8_t>(255.0F * l.intensity[i]);
      colour[i] = {grey, grey, grey};
    }
    return makeFrameMaps(l.camera, l.depth, std::move(colour), config.sensor);
  };
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  double nees = 0;
  double largest_sigma = 0;
  constexpr int kDraws = 10;
  for (int draw = 0; draw < kDraws; ++draw) {
    const RgbdLevel first = look(T_WP, 2 * static_cast<std::uint64_t>(draw) + 1);
    const FrameMaps model = maps(first);
    const SplitWeights split = splitWeights(
        Image<std::uint8_t>(first.depth.width(), first.depth.height(), 255), model.depth);
    BodyModel body(config, model.camera);
    const Image<std::uint8_t> none;
    fuseFrame({model, split.world, split.object.interior, none, SE3(), 1, true}, config, body.map,
              body.prediction);
    Vec6 motion;
    for (int k = 0; k < 6; ++k) motion(k) = 0.01 * normal(random);
    const SE3 T_PC = SE3::exp(motion);
    RgbdLevel live = look(T_WP * T_PC, 2 * static_cast<std::uint64_t>(draw) + 2);
    const Image<float> own =
        splitWeights(Image<std::uint8_t>(live.depth.width(), live.depth.height(), 255), live.depth)
            .world.own;
    std::vector<TrackLevel> pyramid;
    for (RgbdLevel& l : buildPyramid(std::move(live), 3))
      pyramid.push_back({l.camera, l.depth, l.intensity});
    const TrackResult r =
        alignToModel(makeReference(body.prediction, 3, -1.1F), pyramid, weightPyramid(own, 3), T_PC,
                     Mat6::Identity() * 0.01, 100, config);
    ASSERT_TRUE(r.accepted) << r.reason;
    EXPECT_GT(r.likeness, 0.8);
    EXPECT_FALSE(r.blind);
    const Vec6 error = (r.T_PC.inverse() * T_PC).log();
    nees += error.dot(r.covariance.ldlt().solve(error)) / 6.0 / kDraws;
    largest_sigma =
        std::max(largest_sigma, std::sqrt(r.covariance.diagonal().head<3>().maxCoeff()));
  }
  // The smooth texture of this scene has no sampling phase, so the claim may only be timid.
  EXPECT_LT(nees, 1.0);
  EXPECT_LT(largest_sigma, 0.01) << "and still says something";
}

}  // namespace
}  // namespace rf
