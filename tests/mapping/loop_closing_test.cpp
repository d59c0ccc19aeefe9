// SPDX-License-Identifier: BSD-3-Clause
// A map of two pieces: the left of the view, out of view for long, and the right, mapped since.
#include "pipeline/loop_closing.hpp"

#include <cstdint>

#include <gtest/gtest.h>

#include "analytic_scene.hpp"
#include "geometry/undistort.hpp"
#include "mapping/surfel_fusion.hpp"
#include "pipeline/fusion_input.hpp"

namespace rf {
namespace {

constexpr int kOldFrames = 24;   // from frame 1 on
constexpr int kYoungFrom = 104;  // an epoch's first frame
constexpr int kYoungFrames = 24;
constexpr double kDrift = 0.015;  // metres, of the young piece

Mat6 spread(double m, double rad) {
  Vec6 v;
  v << m * m, m * m, m * m, rad * rad, rad * rad, rad * rad;
  return v.asDiagonal();
}

class Loop {
 public:
  /// `claimed`: the standard deviation that the map gives its young piece, metres.
  Loop(const FusionConfig& config, double claimed)
      : undistorter_(test::testCamera()),
        frame_(shot(config, 1)),
        state_(config, frame_.maps.camera) {
    Vec6 xi;
    xi << kDrift, 0, 0, 0, 0, 0;
    map(config, 0, kOldFrames, SE3(), spread(0.0005, 0.0005));
    map(config, kYoungFrom, kYoungFrames, SE3::exp(xi), spread(claimed, claimed));
    predict();
    const auto seen = state_.world.uncertainty.seen(state_.world.map, state_.world.prediction,
                                                    frame_.weights.world.own);
    state_.time = kYoungFrom + kYoungFrames + 16;
    state_.world.uncertainty.fuse(state_.time, seen, spread(0.0005, 0.0005));
    state_.camera_on_map = true;
  }

  bool close(int frames = 1) {
    bool more = false;
    for (int i = 0; i < frames; ++i) {
      ++state_.time;
      more = closeLoop(frame_, state_);
    }
    return more;
  }

  /// How far the young piece lies from where it was put, along the drift, mean, metres.
  double corrected() const { return meanX(true) - young_x_; }
  double oldMoved() const { return meanX(false) - old_x_; }
  void remember() {
    young_x_ = meanX(true);
    old_x_ = meanX(false);
  }

 private:
  FusionInput shot(const FusionConfig& config, int seed) const {
    const test::Shot s = test::shoot(test::room(), SE3(), undistorter_.camera(),
                                     {1.0, 2.0, static_cast<std::uint64_t>(seed)}, 0);
    const SegmentationResult truth = test::truth(s, nullptr, SE3(), SE3(), false);
    return prepareFusionInput(s.frame, truth, undistorter_, config);
  }

  void predict() {
    state_.world.predictor.predict(state_.world.map, state_.world.T_FC, state_.camera,
                                   PredictOptions::from(state_.config), state_.world.prediction);
  }

  // Fuses frames of one half of the view from a pose that is off; the newest pieces' covariance.
  void map(const FusionConfig& config, int from, int frames, const SE3& T_FC,
           const Mat6& covariance) {
    const bool left = from == 0;
    state_.world.T_FC = T_FC;
    for (int k = 0; k < frames; ++k) {
      FusionInput f = shot(config, from + k + 2);
      BodyWeights& world = f.weights.world;
      for (int v = 0; v < world.own.height(); ++v) {
        for (int u = 0; u < world.own.width(); ++u) {
          if ((u < world.own.width() / 2) == left) continue;
          world.own(u, v) = 0;
          world.interior(u, v) = 0;
        }
      }
      predict();
      const Image<std::uint8_t> none;
      state_.world.uncertainty.fuse(from + k, {}, covariance);
      fuseFrame(
          {f.maps, f.weights.world, f.weights.object.interior, none, T_FC, from + k, from + k == 0},
          config, state_.world.map, state_.world.prediction);
    }
    state_.world.T_FC = SE3();
  }

  double meanX(bool young) const {
    double sum = 0;
    int n = 0;
    for (int i = 0; i < state_.world.map.blocks(); ++i) {
      const SurfelBlock& b = state_.world.map.block(i);
      for (int slot = 0; slot < b.count; ++slot) {
        const Surfel s = b.get(slot);
        if ((s.born >= kYoungFrom) != young) continue;
        sum += static_cast<double>(s.point.x());
        ++n;
      }
    }
    return sum / n;
  }

  Undistorter undistorter_;
  FusionInput frame_;
  FusionState state_;
  double young_x_ = 0, old_x_ = 0;
};

TEST(LoopClosing, DriftGoesToTheYoungerPieceInSmallSteps) {
  Loop loop({}, 0.01);
  loop.remember();
  loop.close(5);  // looked at in the fourth, where the counter divides by four, and from there on
  EXPECT_EQ(loop.corrected(), 0) << "two frames that say so are not enough";
  EXPECT_TRUE(loop.close()) << "steps are left";
  EXPECT_LT(loop.corrected(), -0.0005);
  EXPECT_GT(loop.corrected(), -0.003) << "2 mm of the camera a frame";
  loop.close(60);
  EXPECT_NEAR(loop.corrected(), -kDrift, 0.005);
  EXPECT_EQ(loop.oldMoved(), 0);
}

TEST(LoopClosing, WhatTheMapsUncertaintyDoesNotExplainIsAMistake) {
  Loop loop({}, 0.001);
  loop.remember();
  EXPECT_FALSE(loop.close(40));
  EXPECT_EQ(loop.corrected(), 0);
}

TEST(LoopClosing, CanBeSwitchedOff) {
  FusionConfig config;
  config.loop.close = false;
  Loop loop(config, 0.01);
  loop.remember();
  EXPECT_FALSE(loop.close(40));
  EXPECT_EQ(loop.corrected(), 0);
}

}  // namespace
}  // namespace rf
