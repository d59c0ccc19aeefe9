// SPDX-License-Identifier: BSD-3-Clause
// rf-calibrate: where sensors and bodies sit, and how their clocks and scales differ, from motion.

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calibration/report.hpp"
#include "inputs.hpp"
#include "residual_plot.hpp"

namespace {

namespace fs = std::filesystem;
using namespace rf;
using calibration::Problem;

constexpr int kBadOptions = 2;
constexpr int kUnusable = 4;
constexpr int kRefused = 5;

constexpr const char* kFooter =
    "Trajectories are TUM text (timestamp tx ty tz qx qy qz qw). Writes report.md,\n"
    "calibration.yaml, covariance.csv, residuals.csv and residuals.png to the output folder; when\n"
    "the motion does not show what is asked for, report.md alone. See docs/CALIBRATION.md.\n"
    "Exit codes: 0 done, 2 bad options, 4 an input is unusable, 5 refused: the motion does not "
    "show\n"
    "what is asked for.";

void addCommon(CLI::App* app, CalibrateOptions* o) {
  app->add_option("--output", o->output, "Folder for the results; made when missing")->required();
  app->add_option("--estimate", o->estimate,
                  "What to estimate, of translation,rotation,time,scale,turn-scale; the rest keeps "
                  "its prior. Default: all but turn-scale")
      ->delimiter(',');
  app->add_option("--extrinsic", o->extrinsic,
                  "What is known of the transform: x,y,z,qx,qy,qz,qw (m). Directions that the "
                  "motion does not show keep it; without it they are refused")
      ->delimiter(',');
  app->add_option("--sigma-translation", o->sigma_translation,
                  "How well it is known: standard deviation of each axis, m")
      ->check(CLI::Range(1e-4, 10.0))
      ->capture_default_str();
  app->add_option("--sigma-rotation", o->sigma_rotation_deg, "Likewise, degrees")
      ->check(CLI::Range(0.01, 90.0))
      ->capture_default_str();
  app->add_option("--largest-offset", o->largest_offset, "Time offsets up to this are searched, s")
      ->check(CLI::Range(0.0, 5.0))
      ->capture_default_str();
}

/// The motion with its own clock: one trajectory, or a robot folder.
void addMoving(CLI::App* sub, const char* option, const char* what, CalibrateOptions* o) {
  CLI::Option_group* source = sub->add_option_group("source", "what moves");
  source->add_option(option, o->moving, what);
  source->add_option("--robot", o->robot,
                     "Robot folder (robot.yaml, robot.urdf, odometry.txt or twist.csv, joints.csv) "
                     "instead");
  source->require_option(1);
}

void addOdometry(CLI::App& app, CalibrateOptions* o) {
  CLI::App* sub = app.add_subcommand(
      "odometry", "Camera on a base: T_BC, time offset and scale of the wheels' odometry");
  addMoving(sub, "--odometry", "Base poses T_WB of the odometry", o);
  sub->add_option("--camera", o->seen,
                  "Camera poses T_WC that were seen: trajectory, or result folder of rf-run")
      ->required();
  sub->add_option("--config", o->config,
                  "Configuration whose prior.base_to_camera is what is known before");
  addCommon(sub, o);
  sub->callback([o] { o->problem = Problem::kOdometry; });
}

void addGrasp(CLI::App& app, CalibrateOptions* o) {
  CLI::App* sub =
      app.add_subcommand("grasp", "Held object: T_GO and the time offset of the joints");
  CLI::Option_group* source = sub->add_option_group("source", "what moves");
  auto* in_camera = source->add_option("--gripper-in-camera", o->moving,
                                       "Gripper poses T_CG in the camera's frame (kinematics)");
  source->add_option("--gripper", o->moving, "Gripper poses T_WG in any world of their own");
  auto* robot = source->add_option(
      "--robot", o->robot, "Robot folder (robot.yaml, robot.urdf, joints.csv, grasp.csv) instead");
  source->require_option(1);
  sub->add_option("--object", o->seen,
                  "Object poses: result folder of rf-run, or a trajectory (T_WO; with "
                  "--gripper-in-camera: T_CO, or T_WO and --camera)")
      ->required();
  sub->add_option("--camera", o->camera,
                  "Camera poses T_WC of the same run: trajectory or result folder");
  addCommon(sub, o);
  sub->callback([o, in_camera, robot] {
    o->problem = Problem::kGrasp;
    o->same_frame = in_camera->count() + robot->count() > 0;
  });
}

void addHandEye(CLI::App& app, CalibrateOptions* o) {
  CLI::App* sub = app.add_subcommand(
      "hand-eye", "Camera on an arm: T_GC, camera in the hand, and the time offset of the joints");
  addMoving(sub, "--arm", "Poses T_BG of the hand in the arm's base", o);
  sub->add_option("--camera", o->seen,
                  "Camera poses T_WC that were seen: trajectory, or result folder of rf-run")
      ->required();
  addCommon(sub, o);
  sub->callback([o] { o->problem = Problem::kHandEye; });
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text << std::flush;
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

void writeResults(const fs::path& folder, const calibration::CalibrationResult& result) {
  write(folder / "report.md", calibration::toMarkdown(result));
  for (const char* name :
       {"calibration.yaml", "covariance.csv", "residuals.csv", "residuals.png"}) {
    fs::remove(folder / name);
  }
  if (!result.refusal.empty()) return;
  write(folder / "calibration.yaml", calibration::toYaml(result));
  write(folder / "covariance.csv", calibration::covarianceCsv(result));
  write(folder / "residuals.csv", calibration::residualsCsv(result));
  const std::string plot = (folder / "residuals.png").string();
  if (!cv::imwrite(plot, residualPlot(result))) {
    throw std::runtime_error(plot + ": cannot be written");
  }
}

int run(const CalibrateOptions& options) {
  CalibrateInput input;
  try {
    input = readInput(options);
  } catch (const std::invalid_argument& e) {
    fmt::print(stderr, "rf-calibrate: {}\n", e.what());
    return kBadOptions;
  }
  calibration::CalibrationResult result = calibration::calibrate(input.request, input.A, input.X);
  result.notes.insert(result.notes.begin(), input.notes.begin(), input.notes.end());
  fs::create_directories(options.output);
  writeResults(options.output, result);
  if (!result.refusal.empty()) {
    fmt::print(stderr, "rf-calibrate: refused: {}. {}\n", result.refusal,
               "Ask for less with --estimate, or record another motion.");
    return kRefused;
  }
  fmt::print("{}", calibration::toMarkdown(result));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CalibrateOptions options;
  CLI::App app("rf-calibrate: transforms, time offsets and scales from the motion of two sources");
  app.require_subcommand(1);
  app.footer(kFooter);
  addOdometry(app, &options);
  addGrasp(app, &options);
  addHandEye(app, &options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : kBadOptions;
  }
  try {
    return run(options);
  } catch (const std::exception& e) {
    fmt::print(stderr, "rf-calibrate: {}\n", e.what());
    return kUnusable;
  }
}
