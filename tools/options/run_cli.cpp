// SPDX-License-Identifier: BSD-3-Clause
#include "options/run_cli.hpp"

#include <CLI/CLI.hpp>

namespace rf {

void addRunOptions(CLI::App& app, RunOptions& options) {
  app.add_option("--input", options.input,
                 "TUM-layout folder, LCM log with OPENNI_FRAME, or .oni file");
  app.add_option("--output", options.output,
                 "result folder; results of an earlier run in it are replaced")
      ->required();
  app.add_option(
      "--camera-prior", options.camera_prior,
      "camera poses T_WC (TUM text) or 'none'; default: odometry.txt of the input if present");
  app.add_option("--object-prior", options.object_prior,
                 "object poses T_WO (TUM text) or 'none'; default: object_odometry.txt of the "
                 "input if present");
  app.add_option("--robot", options.robot,
                 "robot folder (URDF, odometry, joints, grasps) as source of the priors that no "
                 "option names, or 'none'; default: robot/ of the input if present");
  app.add_option("--calibration", options.calibration,
                 "camera.yaml; default: that of the input folder");
  app.add_option("--simulate-drift", options.simulate_drift,
                 "V,W[,V,W]: add drift of mean V m/s and W rad/s to the camera (and object) prior")
      ->delimiter(',');
  app.add_option("--drift-seed", options.drift_seed, "seed of that drift")->capture_default_str();
  app.add_option("--mode", options.mode,
                 "rigidfusion | rigidfusion-paper | static | static-prior | vo");
  app.add_option("--threads", options.threads, "worker threads; results do not depend on it")
      ->capture_default_str();
  app.add_option("--config", options.config, "configuration (YAML); unknown keys are errors");
  app.add_option("--set", options.set, "override one key: section.key=value (repeatable)");
  app.add_flag("--write-masks", options.write_masks, "write masks/<timestamp>.png");
  app.add_flag("--quiet", options.quiet, "no progress");
}

}  // namespace rf
