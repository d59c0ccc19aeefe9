// SPDX-License-Identifier: BSD-3-Clause
// A cut of a mobile manipulator's drive: priors from its wheels, joints and grasp, its own links
// left out.
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/parallel.hpp"
#include "sequence_run.hpp"
#include "simulated_cut.hpp"
#include "simulation/joint_encoders.hpp"
#include "simulation/manipulator.hpp"
#include "simulation/robot_description.hpp"
#include "simulation/simulator.hpp"
#include "simulation/wheels.hpp"

namespace rf {
namespace {

constexpr int kFirst = 24;  // base and arm start about frame 36
constexpr int kFrames = 60;
constexpr std::uint64_t kSeed = 7;

const sim::Simulator& simulator() {
  static const sim::Simulator instance("carry_omni", kSeed);
  return instance;
}

const SimulatedCut& scene() {
  static const SimulatedCut instance = renderCut(simulator(), kFirst, kFrames, kSeed);
  return instance;
}

std::int64_t utimeOf(double seconds) { return sim::kStartUtime + std::llround(1e6 * seconds); }

/// The robot as its recordings describe it.
RobotPrior robotPrior(const PriorConfig& config) {
  const sim::Manipulator& robot = *simulator().world().robot;
  RobotPrior prior(RobotModel::fromUrdf(sim::robotUrdf(), "robot.urdf"), config);
  for (const auto& [t, pose] : sim::wheelOdometry(robot, {}, -0.5, 4.0, 100, kSeed)) {
    EXPECT_EQ(prior.odometry().addPose(utimeOf(t), pose), "");
  }
  const sim::JointEncoders encoders({}, kSeed);
  for (int k = 0; k <= 450; ++k) {
    const double t = -0.5 + 0.01 * k;
    std::vector<std::string> names;
    std::vector<double> positions;
    for (const auto& [name, value] : encoders.read(robot.joints_at(t))) {
      names.push_back(name);
      positions.push_back(value);
    }
    EXPECT_EQ(prior.joints().add(utimeOf(t), names, positions), "");
  }
  EXPECT_EQ(prior.grasps().add({utimeOf(-0.5), true, robot.T_GO}), "");
  return prior;
}

SequenceRun run(int threads, bool self_filter) {
  setThreads(threads);
  PipelineConfig config;
  config.prior.robot.camera_link = sim::kCameraLink;
  config.prior.robot.gripper_link = sim::kGripperLink;
  config.segmentation.self_filter.enabled = self_filter;
  PriorStage prior(config.prior);
  prior.useRobot(robotPrior(config.prior), true, true);
  SequenceRun out = runSequence(simulator().world().camera, config, prior, framesOf(scene()));
  setThreads(1);
  return out;
}

PixelCounts countAll(const SequenceRun& out) {
  PixelCounts sum;
  for (std::size_t k = 0; k < out.masks.size(); ++k) {
    if (scene().speed[k] > 0.03) sum += countPixels(scene().truth[k], out.masks[k]);
  }
  return sum;
}

double cm(const ErrorStatistics& e) { return 100 * e.rmse; }

TEST(CarrySequence, FindsCameraObjectAndItself) {
  const SequenceRun out = run(2, true);
  const TrajectoryScore camera = scoreCamera(out.camera, scene().camera, out.frames);
  const SE3 world = alignFirstPose(matchPoses(out.camera, scene().camera));
  const TrajectoryScore object = scoreObject(out.object, scene().object, out.frames, world);
  const PixelCounts pixels = countAll(out);
  RecordProperty("camera_cm", std::to_string(cm(camera.ate_first)));
  RecordProperty("object_cm", std::to_string(cm(object.ate_first)));
  std::printf("camera %.2f cm, object %.2f cm, IoU %.3f, self recall %.3f precision %.3f\n",
              cm(camera.ate_first), cm(object.ate_first), pixels.iou(), pixels.selfRecall(),
              pixels.selfPrecision());
  EXPECT_EQ(camera.coverage, 1.0);
  EXPECT_LT(cm(camera.ate_first), 1.5);
  EXPECT_LT(cm(object.ate_first), 2.0);
  EXPECT_GT(pixels.iou(), 0.85);
  EXPECT_GT(pixels.selfRecall(), 0.95);
  EXPECT_GT(pixels.selfPrecision(), 0.5);
  const PixelCounts without = countAll(run(2, false));
  EXPECT_EQ(without.self_right + without.self_wrong, 0);
}

TEST(CarrySequence, OneAndTwoThreadsGiveTheSameBits) {
  const SequenceRun one = run(1, true);
  const SequenceRun two = run(2, true);
  EXPECT_EQ(one.camera, two.camera);
  EXPECT_EQ(one.object, two.object);
  EXPECT_EQ(one.masks, two.masks);
}

}  // namespace
}  // namespace rf
