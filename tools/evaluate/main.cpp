// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "evaluate_folders.hpp"

namespace {

constexpr const char* kFooter =
    "Needs rgb.txt and depth.txt (or associated.txt) in the sequence and camera.txt in the "
    "result.\n"
    "Compares, where both sides are there: camera.txt with groundtruth.txt, object.txt with\n"
    "object_groundtruth.txt, the priors with both, masks/ with mask/ (or masks_hand/), static.ply\n"
    "with surface.ply, object.ply with object_surface.ply. Without surface.ply: how much of\n"
    "static.ply lies on dynamic pixels of the true masks.\n"
    "ATE: RMSE of positions, aligned at the first pose, and aligned in SE(3). RPE: RMSE over 1 s.\n"
    "Exit codes: 0 done, 1 an input is unusable, 106 to 109 wrong arguments.";

void write(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text << std::flush;
  if (!out) throw std::runtime_error(file + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  rf::EvaluationRequest request;
  bool as_json = false;
  std::string per_frame;
  CLI::App app("rf-evaluate: measures a result folder against a sequence's truth");
  app.footer(kFooter);
  app.add_option("--sequence", request.sequence, "Folder in TUM layout, with truth")->required();
  app.add_option("--result", request.result, "Result folder of rf-run or rf-launch")->required();
  app.add_option("--camera-prior", request.camera_prior,
                 "Trajectory file or none; default: camera_prior.txt of the result, else "
                 "odometry.txt of the sequence");
  app.add_option("--object-prior", request.object_prior,
                 "Trajectory file or none; default: object_prior.txt of the result, else "
                 "object_odometry.txt of the sequence");
  app.add_option(
      "--truth-masks", request.truth_masks,
      "Folder of true masks <timestamp>.png: 0 unknown, 1 static, 2 dynamic, 3 the robot");
  app.add_option("--speed-threshold", request.speed_threshold,
                 "The object counts as moving above this speed, m/s")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  app.add_flag("--json", as_json, "Print one JSON object instead of the table");
  app.add_option("--per-frame", per_frame,
                 "Write one CSV row a frame: the object's true speed and displacement since it "
                 "rested, its share, masks and errors");
  CLI11_PARSE(app, argc, argv);
  try {
    request.each_frame = !per_frame.empty();
    const rf::EvaluationReport report = rf::evaluateFolders(request);
    if (!per_frame.empty()) write(per_frame, rf::toCsv(report.each_frame));
    fmt::print("{}", as_json ? rf::toJson(report) : rf::toText(report));
    return 0;
  } catch (const std::exception& e) {
    fmt::print(stderr, "rf-evaluate: {}\n", e.what());
    return 1;
  }
}
