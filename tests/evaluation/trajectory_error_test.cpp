// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/trajectory_error.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace rf {
namespace {

constexpr std::int64_t kStepUs = 50000;  // 20 poses per second
constexpr double kExact = 1e-9;          // closed forms hold to rounding

Vec6 twist(double vx, double vy, double vz, double wx, double wy, double wz) {
  return (Vec6() << vx, vy, vz, wx, wy, wz).finished();
}

/// A curved path without symmetry.
Trajectory curve(int count) {
  Trajectory t;
  for (int i = 0; i < count; ++i) {
    const double s = 0.05 * i;
    const Vec3 p(s, std::sin(s), 0.3 * s * s);
    t.push_back({1000000 + i * kStepUs,
                 SE3(SE3::exp(twist(0, 0, 0, 0.1 * s, 0.2 * std::cos(s), 0.3 * s)).q, p)});
  }
  return t;
}

Trajectory line(int count, double speed) {
  Trajectory t;
  for (int i = 0; i < count; ++i) {
    t.push_back({i * kStepUs, SE3(Eigen::Quaterniond::Identity(), Vec3(speed * 0.05 * i, 0, 0))});
  }
  return t;
}

std::vector<std::int64_t> timesOf(const Trajectory& trajectory) {
  std::vector<std::int64_t> times;
  for (const StampedPose& p : trajectory) times.push_back(p.utime);
  return times;
}

void expectZero(const TrajectoryScore& s) {
  EXPECT_LT(s.ate_first.max, kExact);
  EXPECT_LT(s.ate_aligned.max, kExact);
  EXPECT_LT(s.rpe.translation.max, kExact);
  EXPECT_LT(s.rpe.rotation.max, 1e-7);
}

TEST(Statistics, MatchesItsDefinition) {
  const ErrorStatistics s = statistics({3, 1, 2, 6});
  EXPECT_DOUBLE_EQ(s.rmse, std::sqrt((9.0 + 1 + 4 + 36) / 4));
  EXPECT_DOUBLE_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.max, 6);
  EXPECT_EQ(statistics({}).count, 0U);
}

TEST(CameraScore, IdenticalTrajectoriesHaveNoError) {
  const Trajectory truth = curve(60);
  const TrajectoryScore s = scoreCamera(truth, truth, timesOf(truth));
  expectZero(s);
  EXPECT_EQ(s.matched, 60U);
  EXPECT_EQ(s.coverage, 1.0);
  EXPECT_EQ(s.rpe.translation.count, 40U);
}

TEST(CameraScore, AnotherWorldFrameIsNoError) {
  const Trajectory truth = curve(60);
  Trajectory moved = truth;
  for (StampedPose& p : moved) p.pose = SE3::exp(twist(1, -2, 3, 0.5, 1.0, -2.0)) * p.pose;
  expectZero(scoreCamera(moved, truth, timesOf(truth)));
  Trajectory shifted = truth;
  for (StampedPose& p : shifted) p.pose.t += Vec3(0.1, 0.2, 0.3);
  expectZero(scoreCamera(shifted, truth, timesOf(truth)));
  EXPECT_NEAR(absoluteError(matchPoses(shifted, truth)).rmse, std::sqrt(0.14), kExact)
      << "without alignment the offset is all there is";
}

TEST(CameraScore, ConstantVelocityErrorHasClosedForm) {
  const double error = 0.02;  // m/s
  const Trajectory truth = line(101, 0.3);
  const Trajectory estimate = line(101, 0.3 + error);
  const TrajectoryScore s = scoreCamera(estimate, truth, timesOf(truth));
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < 101; ++i) {
    sum += 0.05 * i;
    squares += 0.05 * i * 0.05 * i;
  }
  const double mean = sum / 101;
  EXPECT_NEAR(s.ate_first.rmse, error * std::sqrt(squares / 101), kExact);
  EXPECT_NEAR(s.ate_aligned.rmse, error * std::sqrt(squares / 101 - mean * mean), kExact);
  EXPECT_NEAR(s.rpe.translation.rmse, error, kExact);
  EXPECT_NEAR(s.rpe.rotation.rmse, 0, kExact);
}

TEST(CameraScore, RotationDriftHasClosedForm) {
  const double rate = 0.05;  // rad/s
  const Trajectory truth = line(101, 0);
  Trajectory estimate = truth;
  for (int i = 0; i < 101; ++i) {
    estimate[static_cast<std::size_t>(i)].pose = SE3::exp(twist(0, 0, 0, 0, 0.05 * i * rate, 0));
  }
  const TrajectoryScore s = scoreCamera(estimate, truth, timesOf(truth));
  EXPECT_NEAR(s.rpe.rotation.rmse, rate, kExact);
  EXPECT_NEAR(s.rpe.translation.rmse, 0, kExact);
  EXPECT_NEAR(s.ate_first.rmse, 0, kExact);
}

TEST(CameraScore, WrongFirstOrientationTurnsTheWholePath) {
  const double angle = 0.1;
  const Trajectory truth = line(81, 0.5);
  Trajectory estimate = truth;
  for (StampedPose& p : estimate) {
    p.pose = SE3(SE3::exp(twist(0, 0, 0, 0, 0, angle)).q, p.pose.t);
  }
  const TrajectoryScore s = scoreCamera(estimate, truth, timesOf(truth));
  const double length = 0.5 * 0.05 * 80;
  EXPECT_NEAR(s.ate_first.max, 2 * std::sin(angle / 2) * length, kExact);
  EXPECT_LT(s.ate_aligned.max, kExact);
  EXPECT_NEAR(s.rpe.translation.rmse, 2 * std::sin(angle / 2) * 0.5, kExact);
}

TEST(CameraScore, MissingFramesCountForCoverageAndLeaveNoPairs) {
  const Trajectory truth = curve(60);
  Trajectory estimate(truth.begin(), truth.begin() + 10);
  estimate.push_back(truth[50]);
  const TrajectoryScore s = scoreCamera(estimate, truth, timesOf(truth));
  EXPECT_EQ(s.posed, 11U);
  EXPECT_DOUBLE_EQ(s.coverage, 11.0 / 60);
  EXPECT_EQ(s.rpe.translation.count, 0U) << "nothing lies one second apart";
  EXPECT_LT(s.ate_first.max, kExact);
  const TrajectoryScore none = scoreCamera({}, truth, timesOf(truth));
  EXPECT_EQ(none.coverage, 0.0);
  EXPECT_EQ(none.matched, 0U);
}

TEST(MatchPoses, IsNearestAndOneToOne) {
  Trajectory truth = line(3, 1);
  Trajectory estimate = {{0, SE3()}, {30000, SE3()}, {52000, SE3()}, {90001, SE3()}};
  const std::vector<PosePair> pairs = matchPoses(estimate, truth);
  ASSERT_EQ(pairs.size(), 3U);
  EXPECT_EQ(pairs[1].utime, 52000) << "30000 and 52000 both want 50000; the nearer gets it";
  EXPECT_EQ(pairs[2].utime, 90001);
}

TEST(AlignPositions, EqualsBruteForceOptimum) {
  std::mt19937_64 rng(3);
  const auto noise = [&] { return 0.05 * (static_cast<double>(rng() >> 11) * 0x1p-52 - 1.0); };
  const Trajectory truth = curve(40);
  std::vector<PosePair> pairs;
  for (const StampedPose& p : truth) {
    pairs.push_back({p.utime, SE3::exp(twist(1, 2, 3, 0.4, 0.5, -1.5)) * p.pose, p.pose});
    pairs.back().estimate.t += Vec3(noise(), noise(), noise());
  }
  const SE3 best = alignPositions(pairs);
  const double rmse = absoluteError(pairs, best).rmse;
  EXPECT_GT(rmse, 1e-3);
  for (int i = 0; i < 200; ++i) {
    const Vec6 d = 0.02 * twist(noise(), noise(), noise(), noise(), noise(), noise());
    EXPECT_GE(absoluteError(pairs, best * SE3::exp(d)).rmse, rmse);
  }
}

TEST(AlignPositions, NeverMirrors) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 8; ++i) {
    const Vec3 p(i & 1, (i >> 1) & 1, (i >> 2) & 1);
    const Vec3 mirrored(-p.x(), p.y(), p.z());
    pairs.push_back(
        {i, SE3(Eigen::Quaterniond::Identity(), p), SE3(Eigen::Quaterniond::Identity(), mirrored)});
  }
  EXPECT_NEAR(alignPositions(pairs).R().determinant(), 1.0, 1e-12);
}

TEST(RelativeError, EqualsIndependentMatrixFormula) {
  const Trajectory truth = curve(70);
  Trajectory estimate;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const double s = 0.01 * static_cast<double>(i);
    estimate.push_back({truth[i].utime, truth[i].pose * SE3::exp(twist(s, -s * s, 0.1 * s, 0.2 * s,
                                                                       s * s, -0.1 * s))});
  }
  double squares_t = 0;
  double squares_r = 0;
  for (std::size_t i = 0; i + 20 < truth.size(); ++i) {
    const Eigen::Matrix4d Q = truth[i].pose.matrix().inverse() * truth[i + 20].pose.matrix();
    const Eigen::Matrix4d P = estimate[i].pose.matrix().inverse() * estimate[i + 20].pose.matrix();
    const Eigen::Matrix4d E = Q.inverse() * P;
    squares_t += E.topRightCorner<3, 1>().squaredNorm();
    const double angle = std::acos(0.5 * (E.topLeftCorner<3, 3>().trace() - 1));
    squares_r += angle * angle;
  }
  const RelativeError rpe = relativeError(matchPoses(estimate, truth));
  EXPECT_EQ(rpe.translation.count, 50U);
  EXPECT_NEAR(rpe.translation.rmse, std::sqrt(squares_t / 50), 1e-12);
  EXPECT_NEAR(rpe.rotation.rmse, std::sqrt(squares_r / 50), 1e-9);
}

TEST(ObjectScore, ConstantOffsetsOfFrameAndWorldAreNoError) {
  const Trajectory truth = curve(60);
  const SE3 W = SE3::exp(twist(1, 2, 3, 0.3, -0.2, 1));
  const SE3 X = SE3::exp(twist(-0.3, 0.1, 0.2, 1, 0.5, 0.2));
  Trajectory estimate;
  for (std::size_t i = 20; i < truth.size(); ++i) {
    estimate.push_back({truth[i].utime, W.inverse() * truth[i].pose * X.inverse()});
  }
  const TrajectoryScore s = scoreObject(estimate, truth, timesOf(truth), W);
  expectZero(s);
  EXPECT_DOUBLE_EQ(s.coverage, 40.0 / 60) << "born late";
  EXPECT_LT((objectOffset(estimate, truth, W)->inverse() * X).log().norm(), kExact);
  EXPECT_FALSE(objectOffset({}, truth, W));
}

TEST(ObjectScore, SeesWhatTheOffsetDoesNotExplain) {
  const Trajectory truth = line(81, 0.2);
  const Trajectory estimate = line(81, 0.25);
  const TrajectoryScore s = scoreObject(estimate, truth, timesOf(truth), SE3());
  EXPECT_NEAR(s.ate_first.max, 0.05 * 4.0, kExact);
  EXPECT_NEAR(s.rpe.translation.rmse, 0.05, kExact);
}

TEST(Speeds, AreCentralDifferences) {
  Trajectory t = line(5, 0.4);
  for (const double v : speeds(t)) EXPECT_NEAR(v, 0.4, kExact);
  t[4].pose.t = t[3].pose.t;
  EXPECT_NEAR(speeds(t)[4], 0, kExact);
  EXPECT_NEAR(speeds(t)[3], 0.2, kExact);
  EXPECT_TRUE(speeds({}).empty());
  EXPECT_EQ(speeds({{0, SE3()}}).at(0), 0.0);
}

}  // namespace
}  // namespace rf
