// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/report.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "calibration/refusal.hpp"

namespace rf::calibration {
namespace {

/// How a parameter is shown.
struct Unit {
  const char* name;
  double factor;
};

Unit unitOf(int parameter) {
  if (parameter <= kZ) return {"mm", 1e3};
  if (parameter <= kYaw) return {"deg", kDegrees};
  if (parameter == kTime) return {"ms", 1e3};
  return {"%", 100};
}

std::string title(Problem problem) {
  switch (problem) {
    case Problem::kOdometry:
      return "Calibration of odometry and camera";
    case Problem::kGrasp:
      return "Calibration of a grasp";
    case Problem::kHandEye:
      return "Calibration of a camera on an arm";
  }
  return {};
}

std::string transformName(Problem problem) {
  if (problem == Problem::kOdometry) return "T_BC";
  return problem == Problem::kGrasp ? "T_GO" : "T_GC";
}

bool active(const CalibrationResult& r, int k) { return r.estimate.covariance(k, k) > 0; }

std::string motionWords(const CalibrationResult& r) {
  const MotionSummary& m = r.motion;
  return fmt::format(
      "## The motion\n{:.1f} s; the {} travelled {:.2f} m and turned by {:.0f} degrees in all, "
      "{:.0f} % / {:.0f} % / {:.0f} % of the turning (squared) about its first, second and third "
      "axis. Its speed varies by {:.2f} m/s and {:.1f} degrees/s.\n\n",
      m.duration, nameOfA(r.problem), m.travelled, m.turned * kDegrees, 100 * m.axis_shares[0],
      100 * m.axis_shares[1], 100 * m.axis_shares[2], m.speed_variation,
      m.turn_variation * kDegrees);
}

/// Observed, at its prior, or in part.
std::string statusOf(const CalibrationResult& r, int k) {
  const double share = r.estimate.observability.share[k];
  std::string start = r.prior.has_transform || k >= kTime ? "at its prior" : "not known";
  if (share > 0.99) return "observed";
  if (share < 0.01) return start;
  return fmt::format("observed to {:.0f} %", 100 * share);
}

std::string parameterTable(const CalibrationResult& r) {
  std::string out =
      "## The values\n| parameter | prior | change | standard deviation | what the motion says "
      "|\n|---|---|---|---|---|\n";
  const ParameterVector change = difference(r.estimate.values, r.prior.values);
  const ParameterVector prior = difference(r.prior.values, CalibrationValues());
  for (int k = 0; k < kParameters; ++k) {
    if (!active(r, k)) continue;
    const Unit u = unitOf(k);
    const bool is_turn = k >= kRoll && k <= kYaw;
    const double base = k >= kScale ? 1 : 0;
    const std::string before =
        is_turn ? "-" : fmt::format("{:.2f} {}", u.factor * (base + prior[k]), u.name);
    out += fmt::format("| {} | {} | {:+.2f} {} | {:.2f} {} | {} |\n", parameterName(r.problem, k),
                       before, u.factor * change[k], u.name,
                       u.factor * std::sqrt(r.estimate.covariance(k, k)), u.name, statusOf(r, k));
  }
  const SE3& T = r.estimate.values.T_AX;
  out += fmt::format(
      "\n{} = translation ({:.6f}, {:.6f}, {:.6f}) m, quaternion x y z w ({:.9f}, {:.9f}, {:.9f}, "
      "{:.9f})\n\n",
      transformName(r.problem), T.t.x(), T.t.y(), T.t.z(), T.q.x(), T.q.y(), T.q.z(), T.q.w());
  return out;
}

std::string directionWords(const CalibrationResult& r) {
  std::string out;
  for (const Direction& d : r.estimate.observability.directions) {
    if (d.observed) continue;
    out += fmt::format(
        "- {}: the data knows it {} the prior; it stays at its prior, its standard deviation is "
        "the prior's.\n",
        directionName(r.problem, d),
        d.gain < 1e-3 ? std::string("not at all beside")
                      : fmt::format("only {:.2g} times as well as", d.gain));
  }
  if (out.empty()) return "Every direction that was asked for is observed.\n\n";
  return "## What the motion does not show\n" + out + "\n";
}

std::string errorTable(const CalibrationResult& r) {
  const auto row = [](const char* what, const ErrorSize& e) {
    return fmt::format("| {} | {} | {:.2f} | {:.3f} |\n", what, e.count, 1e3 * e.translation,
                       kDegrees * e.rotation);
  };
  std::string out =
      r.baseline > 0
          ? fmt::format("## Errors of motions over {:.1f} s, root mean square\n", r.baseline)
          : std::string("## Errors of poses, root mean square\n");
  out += "| part | count | position [mm] | rotation [deg] |\n|---|---|---|---|\n";
  const bool compare = r.prior.has_transform;
  if (compare) out += row("held out, before", r.before);
  out += row("held out, after", r.after);
  if (compare) out += row("fitted, before", r.fit_before);
  out += row("fitted, after", r.fit_after);
  return out +
         "\nThese errors are of a fit that did not use the held-out part; the values above are "
         "then "
         "fitted to everything.\n\n";
}

std::string noiseTable(const CalibrationResult& r) {
  std::string out =
      "## Noise, estimated from the residuals\n| cause | standard deviation |\n|---|---|\n";
  for (const NoiseComponent& c : r.estimate.noise) {
    out += fmt::format("| {} | {:.2g} |\n", c.name, std::sqrt(c.variance));
  }
  return out + "\n";
}

std::string inputWords(const CalibrationResult& r) {
  std::string out = fmt::format(
      "## The input\n{} intervals left out before the fit: {} without poses of the {}, {} with it "
      "frozen while the {} moves, {} with a jump.\n",
      r.dropped.all(), r.dropped.not_covered, nameOfA(r.problem), r.dropped.frozen,
      nameOfX(r.problem), r.dropped.jumps);
  if (r.guess.correlation > 0) {
    out += fmt::format("First guess of the time offset: {:.2f} s (correlation {:.2f}).\n",
                       r.guess.offset, r.guess.correlation);
  }
  for (const std::string& note : r.notes) out += note + ".\n";
  return out + "\n";
}

std::string timestampOf(const CalibrationResult& r, double time) {
  return fmt::format("{:.6f}", 1e-6 * static_cast<double>(r.origin) + time);
}

std::string transformYaml(const SE3& T, const std::string& indent) {
  std::string out;
  const std::array<std::pair<const char*, double>, 7> fields = {{{"x", T.t.x()},
                                                                 {"y", T.t.y()},
                                                                 {"z", T.t.z()},
                                                                 {"qx", T.q.x()},
                                                                 {"qy", T.q.y()},
                                                                 {"qz", T.q.z()},
                                                                 {"qw", T.q.w()}}};
  for (const auto& [name, value] : fields)
    out += fmt::format("{}{}: {:.9f}\n", indent, name, value);
  return out;
}

}  // namespace

std::string toMarkdown(const CalibrationResult& r) {
  std::string out = "# " + title(r.problem) + "\n\n";
  if (!r.refusal.empty()) {
    return out + "**Refused.** The motion does not show what is asked for: " + r.refusal + ".\n\n" +
           motionWords(r) + inputWords(r);
  }
  return out + parameterTable(r) + directionWords(r) + errorTable(r) + motionWords(r) +
         noiseTable(r) + inputWords(r);
}

std::string covarianceCsv(const CalibrationResult& r) {
  static constexpr std::array<const char*, kParameters> kNames = {
      "vx", "vy", "vz", "wx", "wy", "wz", "time_offset", "scale", "turn_scale"};
  const ParameterMatrix P = rightPerturbationCovariance(r.estimate.values, r.estimate.covariance);
  std::string out = "parameter";
  for (const char* n : kNames) out += fmt::format(",{}", n);
  out += '\n';
  for (int i = 0; i < kParameters; ++i) {
    out += kNames[static_cast<std::size_t>(i)];
    for (int k = 0; k < kParameters; ++k) out += fmt::format(",{:.9e}", P(i, k));
    out += '\n';
  }
  return out;
}

std::string residualsCsv(const CalibrationResult& r) {
  std::string out = "timestamp,part,x,y,z,wx,wy,wz,surprise\n";
  for (const ResidualRow& row : r.residuals) {
    out += fmt::format("{},{}", timestampOf(r, row.time),
                       row.held_out ? "held_out" : (row.used ? "fit" : "left_out"));
    for (int k = 0; k < 6; ++k) out += fmt::format(",{:.9f}", row.error[k]);
    out += row.used ? fmt::format(",{:.3f}\n", row.surprise) : std::string(",\n");
  }
  return out;
}

std::string toYaml(const CalibrationResult& r) {
  const CalibrationValues& v = r.estimate.values;
  std::string out = "# " + title(r.problem) + ". Standard deviations: covariance.csv.\n";
  if (r.problem != Problem::kOdometry) {
    return out + transformName(r.problem) + ":\n" + transformYaml(v.T_AX, "  ") +
           fmt::format("time_offset: {:.6f}  # s, added to the {}'s stamps\n", v.time_offset,
                       nameOfA(r.problem));
  }
  out += "prior:\n  base_to_camera:\n" + transformYaml(v.T_AX, "    ");
  out += fmt::format(
      "  robot:\n    odometry_offset: {:.6f}\n    wheel_scale: {:.9f}\n    turn_scale: {:.9f}\n",
      v.time_offset, v.translation_scale, v.rotation_scale);
  return out;
}

}  // namespace rf::calibration
