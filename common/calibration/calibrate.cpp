// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/calibrate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "calibration/closed_form.hpp"
#include "calibration/refusal.hpp"

namespace rf::calibration {
namespace {

constexpr std::size_t kFewestRows = 20;
constexpr double kLargestDroppedShare = 0.5;
constexpr double kUnrelated = 0.6;      ///< residual over motion: nothing is explained
constexpr double kAtRest = 0.015;       ///< m or rad in a row: nothing but noise may be left
constexpr double kGoodGuess = 0.4;      ///< correlation from which the guess is a start
constexpr double kBaseline = 1.0;       ///< s of the motions in the reported errors
constexpr double kLeastTogether = 0.5;  ///< s that both recordings must share

/// All that is known before a fit.
struct Setting {
  const CalibrationRequest& request;
  std::shared_ptr<const Path> A;
  Path X;
  ParameterMask active{};
  CalibrationValues start;  ///< prior with the guessed offset
};

bool asks(const CalibrationRequest& request, ParameterGroup group) {
  return std::find(request.asked.begin(), request.asked.end(), group) != request.asked.end();
}

void checkOverlap(const CalibrationRequest& request, const Path& A, const Path& X,
                  std::int64_t origin) {
  const double together = std::min(A.end(), X.end()) - std::max(A.begin(), X.begin());
  if (together > kLeastTogether) return;
  const double zero = 1e-6 * static_cast<double>(origin);
  throw CalibrationError(fmt::format(
      "the {} has poses from {:.3f} to {:.3f} s, the {} from {:.3f} to {:.3f} s: they must have "
      "a common time (same clock and unit)",
      nameOfA(request.problem), zero + A.begin(), zero + A.end(), nameOfX(request.problem),
      zero + X.begin(), zero + X.end()));
}

template <class Rows>
void checkRows(const CalibrationRequest& request, const Rows& rows) {
  const DroppedRows& dropped = rows.dropped;
  const std::size_t all = rows.fit.size() + rows.held_out.size() + dropped.all();
  const std::string what = fmt::format(
      "{} of {} intervals of {} s can be fitted ({} are held out, {} without {} poses, {} with the "
      "{} frozen while the {} moves, {} with a jump)",
      rows.fit.size(), all, request.rows.interval, rows.held_out.size(), dropped.not_covered,
      nameOfA(request.problem), dropped.frozen, nameOfA(request.problem), nameOfX(request.problem),
      dropped.jumps);
  if (rows.fit.size() < kFewestRows) {
    throw CalibrationError(fmt::format("{}: must be at least {}", what, kFewestRows));
  }
  if (static_cast<double>(dropped.frozen + dropped.jumps) >
      kLargestDroppedShare * static_cast<double>(all)) {
    throw CalibrationError(what + ": frozen and jumping ones must be less than half");
  }
}

ErrorSize sizeOf(const std::vector<Vec6>& errors) {
  ErrorSize size;
  size.count = errors.size();
  for (const Vec6& e : errors) {
    size.translation += e.head<3>().squaredNorm();
    size.rotation += e.tail<3>().squaredNorm();
  }
  const double n = std::max<double>(1, static_cast<double>(size.count));
  size.translation = std::sqrt(size.translation / n);
  size.rotation = std::sqrt(size.rotation / n);
  return size;
}

double startOf(const MotionRow& row) { return row.from; }
double startOf(const PoseRow& row) { return row.time; }

template <class Row>
std::vector<Row> usedOnes(const std::vector<Row>& rows, const std::vector<bool>& used) {
  std::vector<Row> out;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (used[i]) out.push_back(rows[i]);
  }
  return out;
}

void addResiduals(const RowModel& model, const Estimate& e, bool held_out,
                  std::vector<ResidualRow>* out) {
  const std::vector<Vec6> errors = model.poseErrors(e.values);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    out->push_back(
        {model.time(i), held_out, !held_out && e.used[i], errors[i], held_out ? 0 : e.surprise[i]});
  }
}

void sortByTime(std::vector<ResidualRow>* rows) {
  std::sort(rows->begin(), rows->end(),
            [](const ResidualRow& a, const ResidualRow& b) { return a.time < b.time; });
}

std::vector<Vec6> motionsOf(const std::vector<MotionRow>& rows) {
  std::vector<Vec6> motions;
  motions.reserve(rows.size());
  for (const MotionRow& row : rows) motions.push_back(row.d_X.log());
  return motions;
}

/// How far the poses are from the one in the middle of the recording.
std::vector<Vec6> motionsOf(const std::vector<PoseRow>& rows) {
  std::vector<Vec6> motions;
  motions.reserve(rows.size());
  const SE3 back = rows[rows.size() / 2].T_CX.inverse();
  for (const PoseRow& row : rows) motions.push_back((back * row.T_CX).log());
  return motions;
}

/// Residuals as large as the motion: the two sources do not describe one rigid body.
template <class Row>
void checkRelated(const CalibrationRequest& request, const RowModel& model,
                  const std::vector<Row>& rows, const Estimate& e) {
  const ErrorSize moved = sizeOf(motionsOf(rows));
  if (moved.translation < kAtRest && moved.rotation < kAtRest) return;
  const ErrorSize left = sizeOf(model.poseErrors(e.values));
  if (left.translation < kUnrelated * moved.translation ||
      left.rotation < kUnrelated * moved.rotation) {
    return;
  }
  throw CalibrationError(fmt::format(
      "the motions of {0} and {1} have nothing in common: after the fit {2:.1f} mm and {3:.2f} "
      "degrees {6} are left of {4:.1f} mm and {5:.2f} degrees that the {1} moves; are both of one "
      "recording, rigidly connected, their clocks within the largest offset, and is the {1} what "
      "was tracked?",
      nameOfA(request.problem), nameOfX(request.problem), 1e3 * left.translation,
      left.rotation * 180 / std::numbers::pi, 1e3 * moved.translation,
      moved.rotation * 180 / std::numbers::pi,
      request.same_frame ? std::string("of each pose")
                         : fmt::format("per {} s", request.rows.interval)));
}

std::vector<CalibrationValues> startsOf(const Setting& s, const SE3& closed_form) {
  CalibrationValues other = s.start;
  other.T_AX = closed_form;
  if (!s.request.prior.has_transform) return {other};
  const bool whole =
      asks(s.request, ParameterGroup::kTranslation) && asks(s.request, ParameterGroup::kRotation);
  return whole ? std::vector<CalibrationValues>{s.start, other}
               : std::vector<CalibrationValues>{s.start};
}

/// Without a transform of its own the prior is where the closed form lies.
CalibrationPrior completed(const CalibrationPrior& prior, const SE3& closed_form) {
  CalibrationPrior out = prior;
  if (!prior.has_transform) out.values.T_AX = closed_form;
  return out;
}

template <class Row>
std::vector<Row> inOrder(const std::vector<Row>& a, const std::vector<Row>& b) {
  std::vector<Row> out = a;
  out.insert(out.end(), b.begin(), b.end());
  std::sort(out.begin(), out.end(),
            [](const Row& x, const Row& y) { return startOf(x) < startOf(y); });
  return out;
}

/// Errors of held-out and fitted rows at the prior and at the fit without the held-out part.
void compareErrors(const RowModel& fitted, const RowModel& held_out,
                   const CalibrationValues& before, CalibrationResult* out) {
  out->before = sizeOf(held_out.poseErrors(before));
  out->after = sizeOf(held_out.poseErrors(out->check.values));
  out->fit_before = sizeOf(fitted.poseErrors(before));
  out->fit_after = sizeOf(fitted.poseErrors(out->check.values));
}

void fitRelative(const Setting& s, CalibrationResult* out) {
  const MotionRows rows = motionRows(*s.A, s.X, s.start.time_offset, s.request.rows);
  out->dropped = rows.dropped;
  checkRows(s.request, rows);
  const BodyKind kind =
      s.request.problem == Problem::kOdometry ? BodyKind::kWheels : BodyKind::kArm;
  const auto model = [&](std::vector<MotionRow> r) {
    return RelativeRows(s.A, std::move(r), kind, asks(s.request, ParameterGroup::kTurnScale));
  };
  const SE3 closed = closedFormTransform(*s.A, joined(rows.fit, kBaseline), s.start.time_offset);
  const RelativeRows fit = model(rows.fit);
  out->prior = completed(s.request.prior, closed);
  out->check = estimate(fit, startsOf(s, closed), out->prior, s.active);
  checkRelated(s.request, fit, rows.fit, out->check);
  addResiduals(fit, out->check, false, &out->residuals);
  addResiduals(model(rows.held_out), out->check, true, &out->residuals);
  out->baseline = kBaseline;
  compareErrors(model(joined(usedOnes(rows.fit, out->check.used), kBaseline)),
                model(joined(rows.held_out, kBaseline)), s.request.prior.values, out);
  out->estimate =
      estimate(model(inOrder(rows.fit, rows.held_out)), {out->check.values}, out->prior, s.active);
}

void fitAbsolute(const Setting& s, CalibrationResult* out) {
  const PoseRows rows = poseRows(*s.A, s.X, s.start.time_offset, s.request.rows);
  out->dropped = rows.dropped;
  checkRows(s.request, rows);
  const SE3 mean = meanTransform(*s.A, rows.fit, s.start.time_offset);
  out->prior = completed(s.request.prior, mean);
  const auto model = [&](std::vector<PoseRow> r) { return AbsoluteRows(s.A, std::move(r)); };
  out->check = estimate(model(rows.fit), startsOf(s, mean), out->prior, s.active);
  checkRelated(s.request, model(rows.fit), rows.fit, out->check);
  addResiduals(model(rows.fit), out->check, false, &out->residuals);
  addResiduals(model(rows.held_out), out->check, true, &out->residuals);
  compareErrors(model(usedOnes(rows.fit, out->check.used)), model(rows.held_out),
                s.request.prior.values, out);
  out->estimate =
      estimate(model(inOrder(rows.fit, rows.held_out)), {out->check.values}, out->prior, s.active);
}

void checkRequest(const CalibrationRequest& request) {
  if (request.asked.empty()) throw CalibrationError("nothing is asked for");
  const bool scales =
      asks(request, ParameterGroup::kScale) || asks(request, ParameterGroup::kTurnScale);
  if (scales && request.problem != Problem::kOdometry) {
    throw CalibrationError("scale: only odometry has one");
  }
  if (request.same_frame && request.problem != Problem::kGrasp) {
    throw CalibrationError("poses in one frame: only a grasp is calibrated from them");
  }
}

/// The part of A's path that X saw.
MotionSummary sharedMotion(const Setting& s) {
  const double offset = s.start.time_offset;
  return summarise(*s.A, std::max(s.A->begin(), s.X.begin() - offset),
                   std::min(s.A->end(), s.X.end() - offset));
}

void addNotes(CalibrationResult* out) {
  const Estimate& e = out->estimate;
  const auto used = static_cast<std::size_t>(std::count(e.used.begin(), e.used.end(), true));
  if (used < e.used.size()) {
    out->notes.push_back(fmt::format("{} of {} rows contradict the others and were left out",
                                     e.used.size() - used, e.used.size()));
  }
  if (e.widening > 1) {
    out->notes.push_back(fmt::format(
        "errors last longer than the noise model says: variances widened by {:.2f}", e.widening));
  }
  if (!e.converged) out->notes.emplace_back("the solver did not report convergence");
}

}  // namespace

std::string nameOfA(Problem problem) {
  if (problem == Problem::kOdometry) return "odometry";
  return problem == Problem::kGrasp ? "gripper" : "arm";
}

std::string nameOfX(Problem problem) { return problem == Problem::kGrasp ? "object" : "camera"; }

std::string parameterName(Problem problem, int parameter) {
  static constexpr std::array<const char*, kParameters> kNames = {"x",
                                                                  "y",
                                                                  "z",
                                                                  "roll",
                                                                  "pitch",
                                                                  "yaw",
                                                                  "time offset",
                                                                  "scale of distance",
                                                                  "scale of turning"};
  std::string short_name = kNames[static_cast<std::size_t>(parameter)];
  if (parameter >= kTime) return short_name;
  const std::string where = problem == Problem::kOdometry ? "base" : "gripper";
  const std::string height = problem == Problem::kOdometry && parameter == kZ ? " (height)" : "";
  return fmt::format("{}{} of the {} in the {} frame", short_name, height, nameOfX(problem), where);
}

CalibrationResult calibrate(const CalibrationRequest& request, const Trajectory& A,
                            const Trajectory& X) {
  checkRequest(request);
  CalibrationResult out;
  out.problem = request.problem;
  out.asked = request.asked;
  if (!X.empty()) out.origin = X.front().utime;
  Setting s{request, std::make_shared<const Path>(A, out.origin, nameOfA(request.problem)),
            Path(X, out.origin, nameOfX(request.problem)), maskOf(request.asked),
            request.prior.values};
  checkOverlap(request, *s.A, s.X, out.origin);
  if (asks(request, ParameterGroup::kTime)) {
    out.guess = guessOffset(*s.A, s.X, request.largest_offset);
    if (out.guess.correlation >= kGoodGuess) s.start.time_offset = out.guess.offset;
  }
  out.motion = sharedMotion(s);
  if (request.same_frame) {
    fitAbsolute(s, &out);
  } else {
    fitRelative(s, &out);
  }
  sortByTime(&out.residuals);
  out.refusal = refusalOf(request, out.estimate, out.motion, out.fit_after);
  addNotes(&out);
  return out;
}

}  // namespace rf::calibration
