// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include <gtest/gtest.h>

#include "calibration/absolute_rows.hpp"
#include "calibration/motion_rows.hpp"
#include "calibration/relative_rows.hpp"
#include "simulated_motion.hpp"
#include "simulation/random.hpp"

namespace rf::calibration {
namespace {

using namespace testing;

ParameterVector randomDelta(sim::Random* random, double size) {
  ParameterVector d;
  for (int k = 0; k < kParameters; ++k) d[k] = size * random->normal();
  return d;
}

TEST(CalibrationValues, DifferenceUndoesPlus) {
  sim::Random random(1);
  const CalibrationValues from{someCamera(), 0.03, 1.02, 0.99};
  for (int i = 0; i < 20; ++i) {
    const ParameterVector delta = randomDelta(&random, 0.4);
    EXPECT_LT((difference(plus(from, delta), from) - delta).norm(), 1e-12);
  }
}

TEST(CalibrationValues, DerivativesAgreeWithDifferences) {
  sim::Random random(2);
  constexpr double kStep = 1e-6;
  const CalibrationValues from{someCamera(), 0.03, 1.02, 0.99};
  for (int i = 0; i < 10; ++i) {
    const ParameterVector delta = randomDelta(&random, 0.4);
    const CalibrationValues to = plus(from, delta);
    ParameterMatrix by_change;
    ParameterMatrix by_delta;
    for (int k = 0; k < kParameters; ++k) {
      const ParameterVector h = kStep * ParameterVector::Unit(k);
      by_change.col(k) =
          (difference(plus(to, h), from) - difference(plus(to, -h), from)) / (2 * kStep);
      by_delta.col(k) =
          (difference(plus(from, delta + h), to) - difference(plus(from, delta - h), to)) /
          (2 * kStep);
    }
    EXPECT_LT((differenceJacobian(to, from) - by_change).norm(), 1e-7);
    EXPECT_LT((plusJacobian(delta) - by_delta).norm(), 1e-7);
  }
}

/// Derivatives of a model against central differences.
void expectDerivatives(const RowModel& model, const CalibrationValues& values, bool turn_scale) {
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  model.evaluate(values, &r, &J);
  for (int k = 0; k < (turn_scale ? kParameters : kTurnScale); ++k) {
    // Velocities are averaged over 0.1 s on purpose: so is the difference, up to its curvature.
    const double step = k == kTime ? 0.05 : 1e-5;
    const double tolerance = k == kTime ? 0.02 : 2e-4;
    const ParameterVector h = step * ParameterVector::Unit(k);
    Eigen::VectorXd after;
    Eigen::VectorXd before;
    model.evaluate(plus(values, h), &after, nullptr);
    model.evaluate(plus(values, -h), &before, nullptr);
    const Eigen::VectorXd numeric = (after - before) / (2 * step);
    EXPECT_LT((J.col(k) - numeric).norm(), tolerance * numeric.norm() + 1e-6) << "parameter " << k;
  }
}

TEST(RelativeRows, DerivativesAgreeWithDifferences) {
  const CalibrationValues truth{someCamera(), 0.043, 1.03, 0.98};
  const Recording recording = simulateDrive(Drive::kLively, truth, 20, DriveNoise::none(), 4);
  const std::int64_t origin = recording.X.front().utime;
  const auto A = std::make_shared<const Path>(recording.A, origin, "A");
  const MotionRows rows = motionRows(*A, Path(recording.X, origin, "X"), 0.043, RowOptions());
  ParameterVector off = ParameterVector::Constant(0.01);
  for (const bool turn_scale : {false, true}) {
    const RelativeRows model(A, rows.fit, BodyKind::kWheels, turn_scale);
    CalibrationValues values = plus(truth, off);
    if (!turn_scale) values.rotation_scale = 1;
    expectDerivatives(model, values, turn_scale);
  }
}

TEST(AbsoluteRows, DerivativesAgreeWithDifferences) {
  const CalibrationValues truth{someGrip(), -0.02, 1, 1};
  const Recording recording = simulateGrasp(truth, 20, 0, 0, 0, 4);
  const std::int64_t origin = recording.X.front().utime;
  const auto A = std::make_shared<const Path>(recording.A, origin, "A");
  const PoseRows rows = poseRows(*A, Path(recording.X, origin, "X"), -0.02, RowOptions());
  const AbsoluteRows model(A, rows.fit, 1.0);
  expectDerivatives(model, plus(truth, ParameterVector::Constant(0.01)), false);
}

TEST(AbsoluteRows, OtherFormsTellHowLongErrorsLast) {
  // Errors that are forgotten over two seconds: times near it must be likelier than far ones.
  const CalibrationValues truth{someGrip(), 0, 1, 1};
  const Recording recording = simulateGrasp(truth, 60, 0, 0.001, 0.004, 4);
  const std::int64_t origin = recording.X.front().utime;
  const auto A = std::make_shared<const Path>(recording.A, origin, "A");
  const PoseRows rows = poseRows(*A, Path(recording.X, origin, "X"), 0, RowOptions());
  const AbsoluteRows model(A, rows.fit, 2);
  const auto likelihood = [&](const RowModel& form) {
    Eigen::VectorXd r;
    Eigen::MatrixXd J;
    form.evaluate(truth, &r, &J);
    std::vector<NoiseComponent> noise = form.noise(truth);
    estimateVariances(r, J.leftCols<6>(), 40, &noise);
    return restrictedLikelihood(r, J.leftCols<6>(), noise);
  };
  const auto others = model.otherForms();
  ASSERT_GE(others.size(), 5U);
  EXPECT_GT(likelihood(model), likelihood(*others.front()) + 6);
  EXPECT_GT(likelihood(model), likelihood(*others.back()) + 2);
  for (const auto& form : others) EXPECT_EQ(form->rows(), model.rows());
}

TEST(RelativeRows, OfTheTruthAreZero) {
  const CalibrationValues truth{someCamera(), 0.043, 1.03, 0.98};
  const Recording recording = simulateDrive(Drive::kLively, truth, 20, DriveNoise::none(), 4);
  const std::int64_t origin = recording.X.front().utime;
  const auto A = std::make_shared<const Path>(recording.A, origin, "A");
  const MotionRows rows = motionRows(*A, Path(recording.X, origin, "X"), 0.043, RowOptions());
  ASSERT_GT(rows.fit.size(), 30U);
  const RelativeRows model(A, rows.fit, BodyKind::kWheels, true);
  for (const Vec6& e : model.poseErrors(truth)) EXPECT_LT(e.norm(), 1e-9);
}

}  // namespace
}  // namespace rf::calibration
