// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/prior_stage.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "config/yaml.hpp"
#include "priors/simulated_drift.hpp"

namespace rf {
namespace {

Trajectory circle(int count, std::int64_t step_us) {
  Trajectory t;
  for (int i = 0; i < count; ++i) {
    const double s = 0.01 * i;
    t.push_back({i * step_us, SE3::exp((Vec6() << s, 0.3 * s, 0, 0, 0, s).finished())});
  }
  return t;
}

TEST(PriorStage, WithoutSourcesEverythingIsMissing) {
  PriorStage stage{PriorConfig()};
  const MotionPrior prior = stage.process(5, 0);
  EXPECT_EQ(prior.camera, PriorState::kMissing);
  EXPECT_EQ(prior.object, PriorState::kMissing);
  EXPECT_EQ(prior.object_kind, ObjectPriorKind::kNone);
  EXPECT_EQ(prior.utime_a, prior.utime_b);
  EXPECT_TRUE(stage.covers(1000000000));
}

TEST(PriorStage, GivesIncrementsBetweenFrames) {
  PriorStage stage{PriorConfig()};
  stage.addCameraPoses(circle(100, 10000));
  stage.addObjectPoses(circle(100, 10000));
  const MotionPrior first = stage.process(15000, 0);
  EXPECT_EQ(first.camera, PriorState::kValid);
  EXPECT_EQ(first.T_CaCb, SE3());
  const MotionPrior second = stage.process(48000, 1);
  EXPECT_EQ(second.utime_a, 15000);
  EXPECT_EQ(second.utime_b, 48000);
  EXPECT_EQ(second.object_kind, ObjectPriorKind::kWorldFrame);
  EXPECT_LT((first.T_WCb * second.T_CaCb * second.T_WCb.inverse()).log().norm(), 1e-12);
  EXPECT_EQ(second.T_XOa, first.T_XOb);
  const double dt = 0.033;
  EXPECT_NEAR(second.camera_cov(0, 0), std::pow(0.06 * dt, 2), 1e-15);
  EXPECT_NEAR(second.camera_cov(5, 5), std::pow(0.4 * dt, 2), 1e-15);
  EXPECT_NEAR(second.object_cov(1, 1), std::pow(0.015 * dt, 2), 1e-15);
  EXPECT_NEAR(second.object_cov(4, 4), std::pow(0.1 * dt, 2), 1e-15);
  EXPECT_THROW(stage.process(48000, 2), std::invalid_argument);
}

TEST(PriorStage, CarriesOdometryIntoTheCameraFrame) {
  PriorConfig config;
  config.base_to_camera = {0.2, -0.1, 0.5, -0.5, 0.5, -0.5, 0.5};
  const SE3 T_BC = toTransform(config.base_to_camera, "x");
  PriorStage stage(config);
  const Trajectory T_WB = circle(10, 10000);
  stage.addCameraPoses(T_WB);
  stage.process(10000, 0);
  const MotionPrior prior = stage.process(40000, 1);
  const SE3 expected = (T_WB[1].pose * T_BC).inverse() * (T_WB[4].pose * T_BC);
  EXPECT_LT((prior.T_CaCb.inverse() * expected).log().norm(), 1e-12);
  EXPECT_LT((prior.T_WCb.inverse() * T_WB[4].pose * T_BC).log().norm(), 1e-12);
  // a pure rotation error of the base moves the camera that sits 0.55 m away
  const double sigma_v = 0.06 * 0.03;
  const double trace = prior.camera_cov.topLeftCorner<3, 3>().trace();
  EXPECT_GT(trace, 3 * sigma_v * sigma_v * 1.5);
  EXPECT_LT((prior.camera_cov - prior.camera_cov.transpose()).norm(), 1e-15);
}

TEST(PriorStage, KinematicsGiveTheObjectInTheCamera) {
  PriorConfig config;
  config.object_frame = "camera";
  PriorStage stage(config);
  const Trajectory T_CO = circle(10, 10000);
  stage.addObjectPoses(T_CO);
  stage.process(0, 0);
  const MotionPrior prior = stage.process(30000, 1);
  EXPECT_EQ(prior.object_kind, ObjectPriorKind::kCameraFrame);
  // d(T_COa T_COb^-1) by differences of a perturbed increment
  Mat6 jacobian;
  const SE3 d = prior.T_XOa.inverse() * prior.T_XOb;
  const SE3 m = prior.T_XOa * prior.T_XOb.inverse();
  for (int i = 0; i < 6; ++i) {
    const Vec6 e = 1e-5 * Vec6::Unit(i);
    const auto motion = [&](const Vec6& x) {
      return prior.T_XOa * (prior.T_XOa * d * SE3::exp(x)).inverse();
    };
    jacobian.col(i) = ((m.inverse() * motion(e)).log() - (m.inverse() * motion(-e)).log()) / 2e-5;
  }
  const Mat6 in_object = incrementCovariance(config.object, d, 0.03);
  EXPECT_LT((prior.object_cov - jacobian * in_object * jacobian.transpose()).norm(), 1e-12);
}

TEST(PriorStage, FlagsMissingAndLateDataWithReasons) {
  PriorStage stage{PriorConfig()};
  stage.expectObject();
  stage.addCameraPoses(circle(10, 10000));
  EXPECT_FALSE(stage.covers(5000));
  stage.process(80000, 0);
  EXPECT_EQ(stage.status().object_reason, "no pose received");
  const MotionPrior late = stage.process(120000, 1);
  EXPECT_EQ(late.camera, PriorState::kExtrapolated);
  EXPECT_EQ(late.object, PriorState::kMissing);
  EXPECT_EQ(late.object_kind, ObjectPriorKind::kWorldFrame);
  EXPECT_EQ(stage.status().camera_reason, "0.030 s after the newest pose");
  const MotionPrior lost = stage.process(2000000, 2);
  EXPECT_EQ(lost.camera, PriorState::kMissing);
  stage.addCameraPose(2030000, SE3());
  stage.addCameraPose(2040000, SE3());
  const MotionPrior back = stage.process(2035000, 3);
  EXPECT_EQ(back.camera, PriorState::kMissing) << "no guess across a gap";
  EXPECT_EQ(stage.status().camera_reason,
            "previous frame: gap of 1.940 s between poses (limit 0.2 s)");
  EXPECT_EQ(stage.status().camera_missing, 2);
}

TEST(PriorStage, DropsBadPosesAndCountsThem) {
  PriorStage stage{PriorConfig()};
  SE3 nan;
  nan.t.y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(stage.addCameraPose(1, nan), PoseVerdict::kNotFinite);
  EXPECT_EQ(stage.cameraCounts().not_finite, 1);
  EXPECT_EQ(stage.process(1, 0).camera, PriorState::kMissing);
}

TEST(PriorStage, RefusesUnusableConfigurations) {
  PriorConfig config;
  config.base_to_camera.qw = 0.5;
  EXPECT_THROW(PriorStage{config}, std::invalid_argument);
  config = {};
  config.object_frame = "moon";
  EXPECT_THROW(PriorStage{config}, std::invalid_argument);
  config = {};
  loadConfigText("camera: {sigma_v: 0.01}\nobject_frame: camera\n", "t", config);
  EXPECT_EQ(config.camera.sigma_v, 0.01);
  EXPECT_EQ(config.object.sigma_w, 0.1) << "the object keeps its own defaults";
  EXPECT_NO_THROW(checkConfig(config, "t"));
}

TEST(SimulatedDrift, KeepsTimesAndTheFirstPose) {
  const Trajectory truth = circle(60, 33333);
  const Trajectory drifted = withDrift(truth, {0.06, 0.4, 3, DriftStream::kCamera});
  ASSERT_EQ(drifted.size(), truth.size());
  EXPECT_EQ(drifted.front(), truth.front());
  EXPECT_EQ(drifted.back().utime, truth.back().utime);
  EXPECT_GT((drifted.back().pose.inverse() * truth.back().pose).log().norm(), 1e-3);
}

}  // namespace
}  // namespace rf
