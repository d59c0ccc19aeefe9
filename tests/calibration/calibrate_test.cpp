// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/calibrate.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/report.hpp"
#include "config/yaml.hpp"
#include "pipeline/pipeline_config.hpp"
#include "simulated_motion.hpp"

namespace rf::calibration {
namespace {

using namespace testing;
using ::testing::HasSubstr;
using ::testing::Not;
using Group = ParameterGroup;

constexpr double kDegree = std::numbers::pi / 180;

CalibrationRequest odometryRequest(const CalibrationValues& truth, std::uint64_t seed = 1) {
  CalibrationRequest request;
  request.asked = {Group::kTranslation, Group::kRotation, Group::kTime, Group::kScale};
  request.prior =
      priorAround(truth, CalibrationPrior(), {Group::kTranslation, Group::kRotation}, seed);
  request.prior.values.time_offset = 0;
  request.prior.values.translation_scale = 1;
  return request;
}

CalibrationRequest armRequest() {
  CalibrationRequest request;
  request.problem = Problem::kHandEye;
  request.asked = {Group::kTranslation, Group::kRotation, Group::kTime};
  request.prior.has_transform = false;
  return request;
}

const CalibrationValues kDriven{someCamera(), 0.043, 1.03, 1};
const CalibrationValues kHeld{someGrip(), -0.037, 1, 1};

/// The text of the CalibrationError, or that there was none.
std::string errorOf(const CalibrationRequest& request, const Trajectory& A, const Trajectory& X) {
  try {
    calibrate(request, A, X);
  } catch (const CalibrationError& e) {
    return e.what();
  }
  return "no error";
}

// --- recovery without noise ---

TEST(Odometry, IsRecoveredExactlyButForTheHeight) {
  const Recording r = simulateDrive(Drive::kLively, kDriven, 40, DriveNoise::none(), 1);
  const CalibrationRequest request = odometryRequest(kDriven);
  const CalibrationResult result = calibrate(request, r.A, r.X);
  ASSERT_EQ(result.refusal, "");
  const ParameterVector error = difference(result.estimate.values, kDriven);
  for (int k = 0; k < kTurnScale; ++k) {
    const double found = k == kZ ? 0 : std::abs(error[k]);
    EXPECT_LT(found, 1e-6) << parameterName(result.problem, k);
  }
  EXPECT_NEAR(result.estimate.values.T_AX.t.z(), request.prior.values.T_AX.t.z(), 1e-6);
}

TEST(Odometry, ScaleOfTurningIsRecovered) {
  CalibrationValues truth = kDriven;
  truth.rotation_scale = 0.97;
  const Recording r = simulateDrive(Drive::kLively, truth, 40, DriveNoise::none(), 1);
  CalibrationRequest request = odometryRequest(truth);
  request.asked.push_back(Group::kTurnScale);
  request.prior.values.rotation_scale = 1;
  const CalibrationResult result = calibrate(request, r.A, r.X);
  EXPECT_NEAR(result.estimate.values.rotation_scale, 0.97, 1e-6);
  EXPECT_NEAR(result.estimate.values.time_offset, truth.time_offset, 1e-6);
}

TEST(HandEye, IsRecoveredExactlyWithoutAPrior) {
  const Recording r = simulateArm(Reach::kFree, kHeld, 40, 0, DriveNoise::none(), 1);
  const CalibrationResult result = calibrate(armRequest(), r.A, r.X);
  ASSERT_EQ(result.refusal, "");
  EXPECT_LT(difference(result.estimate.values, kHeld).norm(), 1e-6);
}

TEST(Grasp, IsRecoveredExactlyInOneFrameAndInTwo) {
  const Recording r = simulateGrasp(kHeld, 40, 0, 0, 0, 1);
  CalibrationRequest request = armRequest();
  request.problem = Problem::kGrasp;
  for (const bool same_frame : {true, false}) {
    request.same_frame = same_frame;
    const CalibrationResult result = calibrate(request, r.A, r.X);
    ASSERT_EQ(result.refusal, "");
    EXPECT_LT(difference(result.estimate.values, kHeld).norm(), 1e-6) << same_frame;
  }
}

TEST(Odometry, ALargeOffsetIsFound) {
  CalibrationValues truth = kDriven;
  for (const double offset : {-0.28, 0.28}) {
    truth.time_offset = offset;
    const Recording r = simulateDrive(Drive::kLively, truth, 40, DriveNoise(), 2);
    const CalibrationResult result = calibrate(odometryRequest(truth), r.A, r.X);
    EXPECT_NEAR(result.estimate.values.time_offset, offset, 0.006);
  }
}

// --- what the motion does not show ---

TEST(Odometry, APlanarDriveDoesNotShowTheHeight) {
  const Recording r = simulateDrive(Drive::kLively, kDriven, 40, DriveNoise(), 3);
  const CalibrationRequest request = odometryRequest(kDriven, 3);
  const CalibrationResult result = calibrate(request, r.A, r.X);
  int unseen = 0;
  for (const Direction& d : result.estimate.observability.directions) {
    if (d.observed) continue;
    ++unseen;
    EXPECT_GT(std::abs(d.vector[kZ]), 0.999);
  }
  EXPECT_EQ(unseen, 1);
  EXPECT_NEAR(std::sqrt(result.estimate.covariance(kZ, kZ)), request.prior.sigma_translation, 1e-4);
  EXPECT_THAT(toMarkdown(result),
              HasSubstr("z (height) of the camera in the base frame: the data"));
  EXPECT_THAT(toMarkdown(result), HasSubstr("it stays at its prior"));
}

TEST(Odometry, ALineShowsTwoAnglesScaleAndTimeOnly) {
  const Recording r = simulateDrive(Drive::kStraight, kDriven, 40, DriveNoise(), 3);
  CalibrationRequest request = odometryRequest(kDriven, 3);
  const CalibrationResult refused = calibrate(request, r.A, r.X);
  EXPECT_THAT(refused.refusal, HasSubstr("translation of the camera: the odometry turned by"));
  EXPECT_THAT(refused.refusal, HasSubstr("at least 30 are needed"));
  EXPECT_THAT(toMarkdown(refused), HasSubstr("**Refused.**"));

  request.asked = {Group::kRotation, Group::kTime, Group::kScale};
  const CalibrationResult result = calibrate(request, r.A, r.X);
  ASSERT_EQ(result.refusal, "");
  EXPECT_EQ(result.estimate.values.T_AX.t, request.prior.values.T_AX.t) << "not asked for";
  const ParameterVector share = result.estimate.observability.share;
  EXPECT_LT(share[kRoll], 0.05) << "turning about the way is not seen";
  EXPECT_GT(share[kPitch], 0.95);
  EXPECT_GT(share[kYaw], 0.95);
  EXPECT_GT(share[kScale], 0.99);
}

TEST(Odometry, SteadyTravelDoesNotShowTheTimeOffset) {
  const Recording r = simulateDrive(Drive::kSteady, kDriven, 40, DriveNoise(), 3);
  CalibrationRequest request = odometryRequest(kDriven, 3);
  request.asked = {Group::kRotation, Group::kTime};
  EXPECT_THAT(calibrate(request, r.A, r.X).refusal,
              HasSubstr("time offset: the speed of the odometry varies by"));
}

TEST(Odometry, TurningOnTheSpotDoesNotShowTheScale) {
  const Recording r = simulateDrive(Drive::kOnTheSpot, kDriven, 40, DriveNoise(), 3);
  const CalibrationResult result = calibrate(odometryRequest(kDriven, 3), r.A, r.X);
  EXPECT_THAT(result.refusal, HasSubstr("scale: the odometry travelled 0."));
}

TEST(Odometry, StandingStillShowsNothing) {
  Recording r = simulateDrive(Drive::kSteady, kDriven, 20, DriveNoise(), 3);
  for (StampedPose& p : r.A) p.pose = SE3();
  for (std::size_t i = 0; i < r.X.size(); ++i) {
    // The camera's noise alone, without its motion.
    r.X[i].pose = SE3::exp(0.001 * Vec6::Constant(i % 7 < 3 ? 1.0 : -1.0));
  }
  const CalibrationResult result = calibrate(odometryRequest(kDriven, 3), r.A, r.X);
  EXPECT_THAT(result.refusal,
              HasSubstr("translation of the camera: the odometry turned by 0 degrees"));
  EXPECT_THAT(result.refusal, HasSubstr("time offset"));
  EXPECT_THAT(result.refusal, HasSubstr("scale: the odometry travelled 0.00 m"));
}

TEST(HandEye, OneAxisNeedsAPrior) {
  const Recording r = simulateArm(Reach::kPlanar, kHeld, 40, 0.0005, DriveNoise(), 3);
  CalibrationRequest request = armRequest();
  const CalibrationResult refused = calibrate(request, r.A, r.X);
  EXPECT_THAT(refused.refusal, HasSubstr("z of the camera in the gripper frame"));
  EXPECT_THAT(refused.refusal, HasSubstr("of the turning is about one axis"));
  request.prior =
      priorAround(kHeld, CalibrationPrior(), {Group::kTranslation, Group::kRotation}, 3);
  request.prior.values.time_offset = 0;
  const CalibrationResult result = calibrate(request, r.A, r.X);
  ASSERT_EQ(result.refusal, "");
  EXPECT_LT(result.estimate.observability.share[kZ], 0.01);
  EXPECT_NEAR(result.estimate.values.T_AX.t.z(), request.prior.values.T_AX.t.z(), 1e-6);
}

TEST(HandEye, WithoutTurningIsRefused) {
  const Recording r = simulateArm(Reach::kSliding, kHeld, 40, 0.0005, DriveNoise(), 3);
  EXPECT_THAT(calibrate(armRequest(), r.A, r.X).refusal,
              HasSubstr("translation of the camera: the arm turned by"));
}

TEST(Grasp, PosesThatDoNotFollowTheGripperAreNamed) {
  const Recording one = simulateGrasp(kHeld, 30, 0.0005, 0.002, 0.001, 1);
  Recording other = simulateGrasp(kHeld, 30, 0.0005, 0.002, 0.001, 2);
  CalibrationRequest request = armRequest();
  request.problem = Problem::kGrasp;
  request.same_frame = true;
  std::string said;
  try {
    said = calibrate(request, one.A, other.X).refusal;
  } catch (const CalibrationError& e) {
    said = e.what();
  }
  EXPECT_THAT(said, HasSubstr("tracked"));
  EXPECT_THAT(said, Not(HasSubstr("turn more")));
}

// --- bad input ---

TEST(Input, TimeThatGoesBackwardsIsNamed) {
  Recording r = simulateDrive(Drive::kLively, kDriven, 20, DriveNoise(), 1);
  std::swap(r.A[500], r.A[501]);
  EXPECT_THAT(errorOf(odometryRequest(kDriven), r.A, r.X), HasSubstr("odometry: pose 501: time ="));
}

TEST(Input, NumbersThatAreNotFiniteAreNamed) {
  Recording r = simulateDrive(Drive::kLively, kDriven, 20, DriveNoise(), 1);
  r.X[40].pose.t.y() = std::nan("");
  EXPECT_THAT(errorOf(odometryRequest(kDriven), r.A, r.X), HasSubstr("camera: pose 40 at"));
  r.X[40].pose.t.y() = 0;
  r.A[7].pose.q.coeffs() *= 1.5;
  EXPECT_THAT(errorOf(odometryRequest(kDriven), r.A, r.X), HasSubstr("odometry: pose 7 at"));
}

TEST(Input, TooLittleIsNamed) {
  Recording r = simulateDrive(Drive::kLively, kDriven, 3, DriveNoise(), 1);
  EXPECT_THAT(errorOf(odometryRequest(kDriven), r.A, r.X), HasSubstr("must be at least 20"));
  EXPECT_THAT(errorOf(odometryRequest(kDriven), {}, r.X), HasSubstr("odometry: 0 poses"));
  EXPECT_THAT(errorOf(odometryRequest(kDriven), r.A, {}), HasSubstr("camera: 0 poses"));
}

TEST(Input, ClocksWithoutACommonTimeAreNamed) {
  Recording r = simulateDrive(Drive::kLively, kDriven, 20, DriveNoise(), 1);
  for (StampedPose& p : r.A) p.utime += 1000000000;
  EXPECT_THAT(errorOf(odometryRequest(kDriven), r.A, r.X), HasSubstr("must have a common time"));
}

TEST(Input, OdometryThatIsFrozenThroughoutIsNamed) {
  Recording r = simulateDrive(Drive::kLively, kDriven, 20, DriveNoise(), 1);
  for (StampedPose& p : r.A) p.pose = r.A.front().pose;
  EXPECT_THAT(errorOf(odometryRequest(kDriven), r.A, r.X), HasSubstr("with the odometry frozen"));
}

TEST(Input, MotionsOfTwoRecordingsHaveNothingInCommon) {
  const Recording r = simulateDrive(Drive::kLively, kDriven, 40, DriveNoise(), 1);
  const Recording other = simulateArm(Reach::kFree, kHeld, 40, 0, DriveNoise(), 9);
  EXPECT_THAT(errorOf(odometryRequest(kDriven), r.A, other.X), HasSubstr("nothing in common"));
}

/// Freezes, a jump, a hole and a lost camera in an otherwise good recording.
TEST(Input, FaultsInPartsAreLeftOutAndCounted) {
  Recording r = simulateDrive(Drive::kLively, kDriven, 60, DriveNoise(), 5);
  for (std::size_t i = 800; i < 900; ++i) r.A[i].pose = r.A[799].pose;  // 2 s of 61
  const SE3 leap(Eigen::Quaterniond::Identity(), Vec3(0.4, 0.2, 0));
  for (std::size_t i = 1500; i < r.A.size(); ++i) r.A[i].pose = leap * r.A[i].pose;
  for (std::size_t i = 1000; i < 1010; ++i)
    r.X[i].pose = r.X[i].pose * SE3(leap.q, Vec3(0, 0, 0.05));
  r.A.erase(r.A.begin() + 2200, r.A.begin() + 2250);
  const CalibrationResult result = calibrate(odometryRequest(kDriven, 5), r.A, r.X);
  ASSERT_EQ(result.refusal, "");
  EXPECT_GT(result.dropped.frozen, 2U);
  EXPECT_GT(result.dropped.jumps, 0U);
  EXPECT_GT(result.dropped.not_covered, 3U);
  const ParameterVector error = difference(result.estimate.values, kDriven);
  EXPECT_LT(error.head<2>().norm(), 0.006);
  EXPECT_LT(error.segment<3>(kRoll).norm(), 0.3 * kDegree);
  EXPECT_LT(std::abs(error[kTime]), 0.003);
}

TEST(Input, RequestsThatMakeNoSenseAreRefused) {
  const Recording r = simulateArm(Reach::kFree, kHeld, 20, 0, DriveNoise::none(), 1);
  CalibrationRequest request = armRequest();
  request.asked = {};
  EXPECT_THAT(errorOf(request, r.A, r.X), HasSubstr("nothing is asked for"));
  request.asked = {Group::kScale};
  EXPECT_THAT(errorOf(request, r.A, r.X), HasSubstr("only odometry has one"));
}

// --- results ---

TEST(Result, TheHeldOutPartGetsBetterToo) {
  const Recording r = simulateDrive(Drive::kLively, kDriven, 60, DriveNoise(), 6);
  const CalibrationResult result = calibrate(odometryRequest(kDriven, 6), r.A, r.X);
  EXPECT_GT(result.before.count, 10U);
  EXPECT_LT(result.after.translation, 0.7 * result.before.translation);
  EXPECT_LT(result.after.rotation, 0.9 * result.before.rotation);
  std::size_t held_out = 0;
  for (const ResidualRow& row : result.residuals) held_out += row.held_out ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(held_out) / static_cast<double>(result.residuals.size()), 1.0 / 3,
              0.06);
}

TEST(Result, IsTheSameAgain) {
  const Recording r = simulateDrive(Drive::kLively, kDriven, 30, DriveNoise(), 6);
  const CalibrationRequest request = odometryRequest(kDriven, 6);
  EXPECT_EQ(residualsCsv(calibrate(request, r.A, r.X)), residualsCsv(calibrate(request, r.A, r.X)));
}

TEST(Result, YamlIsAConfigurationOfThePipeline) {
  const Recording r = simulateDrive(Drive::kLively, kDriven, 30, DriveNoise(), 6);
  const CalibrationResult result = calibrate(odometryRequest(kDriven, 6), r.A, r.X);
  PipelineConfig config;
  loadConfigText(toYaml(result), "calibration.yaml", config);
  const SE3 T = toTransform(config.prior.base_to_camera, "prior.base_to_camera");
  EXPECT_LT((T.inverse() * result.estimate.values.T_AX).log().norm(), 1e-8);
}

}  // namespace
}  // namespace rf::calibration
