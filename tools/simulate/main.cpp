// SPDX-License-Identifier: BSD-3-Clause
// rf-simulate: writes a simulated RGB-D sequence with exact truth as a folder in the TUM layout.
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include <malloc.h>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "geometry/parallel.hpp"
#include "sequence_writer.hpp"
#include "simulation/simulator.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;

volatile std::sig_atomic_t g_stop = 0;

constexpr int kExitStopped = 130;

constexpr const char* kFooter =
    "OUTPUT is TUM layout: rgb.txt depth.txt rgb/ depth/ camera.yaml; the priors with the drift "
    "of\n"
    "--camera-drift and --object-drift in odometry.txt (T_WC) and object_odometry.txt (T_WO); the\n"
    "truth in groundtruth.txt, object_groundtruth.txt, mask/ (0 no depth, 1 static world, 2 "
    "moving\n"
    "body, also while it rests), surface.ply (world frame) and object_surface.ply (object frame),\n"
    "object_motion.txt (speed and share of the object per frame).\n"
    "Exit codes: 0 done, 1 failed, 106 to 109 wrong arguments, 130 stopped by a signal (the "
    "frames\n"
    "written until then are a valid sequence).";

struct Arguments {
  bool list = false;
  std::string scene;
  std::uint64_t seed = 1;
  std::optional<std::uint64_t> drift_seed;
  std::string camera_drift = "0.06,0.4";
  std::string object_drift = "0.015,0.1";
  int start = 0;
  int frames = 0;
  double noise = 1;
  int threads = 1;
  bool overwrite = false;
  std::string output;
};

void declare(CLI::App& app, Arguments& a) {
  app.footer(kFooter);
  app.add_flag("--list", a.list, "Print the scenes with their frames and a line each");
  app.add_option("--scene", a.scene, "Scene to render, one of --list");
  app.add_option("--seed", a.seed, "Decor, textures, layout and sensor noise")
      ->capture_default_str();
  app.add_option("--drift-seed", a.drift_seed, "Drift of the priors; default: the value of --seed");
  app.add_option("--camera-drift", a.camera_drift,
                 "Mean drift V,W of odometry.txt in m/s and rad/s, or none")
      ->capture_default_str();
  app.add_option("--object-drift", a.object_drift,
                 "Mean drift V,W of object_odometry.txt in m/s and rad/s, or none")
      ->capture_default_str();
  app.add_option("--start", a.start, "First frame of the choreography that is written")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--frames", a.frames, "Frames to write; 0: to the scene's end")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--noise", a.noise, "Factor on the noise of depth and picture")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  app.add_option("--threads", a.threads, "Worker threads; the bytes written do not depend on it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_flag("--overwrite", a.overwrite, "Empty the output folder's sequence first");
  app.add_option("--output", a.output, "Folder to write, created when missing");
}

std::optional<PriorDrift> parseDrift(const std::string& option, const std::string& text) {
  if (text == "none") return std::nullopt;
  PriorDrift drift{};
  char rest = 0;
  const bool two = std::sscanf(text.c_str(), "%lf,%lf%c", &drift.translation_mps,
                               &drift.rotation_radps, &rest) == 2;
  if (!two || !(drift.translation_mps >= 0 && drift.translation_mps <= 100) ||
      !(drift.rotation_radps >= 0 && drift.rotation_radps <= 100)) {
    throw std::runtime_error(option + " = \"" + text +
                             "\": must be none or two numbers V,W from 0 to 100 (m/s, rad/s)");
  }
  return drift;
}

void printScenes() {
  for (const sim::SceneInfo& s : sim::scenes()) {
    fmt::print("{:<12} {:>4} frames  {}\n", s.name, s.frames, s.summary);
  }
}

/// Removes what an earlier run wrote; nothing else in the folder is touched.
void removeSequence(const fs::path& folder) {
  for (const char* sub : {"rgb", "depth", "mask", "robot"}) fs::remove_all(folder / sub);
  for (const char* file :
       {"rgb.txt", "depth.txt", "camera.yaml", "groundtruth.txt", "object_groundtruth.txt",
        "object2_groundtruth.txt", "odometry.txt", "object_odometry.txt", "object_motion.txt",
        "surface.ply", "object_surface.ply"}) {
    fs::remove(folder / file);
  }
}

void prepareFolder(const fs::path& folder, bool overwrite) {
  if (fs::exists(folder) && !fs::is_directory(folder)) {
    throw std::runtime_error(folder.string() + ": is not a folder");
  }
  if (overwrite) removeSequence(folder);
  if (!overwrite && fs::exists(folder) && !fs::is_empty(folder)) {
    throw std::runtime_error(folder.string() + ": is not empty; pass --overwrite to replace it");
  }
  fs::create_directories(folder);
}

int lastFrame(const Arguments& a, int available) {
  if (a.start >= available) {
    throw std::runtime_error(
        fmt::format("--start = {}: scene {} has frames 0 to {}", a.start, a.scene, available - 1));
  }
  const int wanted = a.frames == 0 ? available - a.start : a.frames;
  if (wanted > available - a.start) {
    throw std::runtime_error(fmt::format("--frames = {}: scene {} has {} frames from --start {} on",
                                         a.frames, a.scene, available - a.start, a.start));
  }
  return a.start + wanted;
}

/// Keeps freed images for the next frame's: the default gives each back to the system and pays
/// for its pages again.
void keepFreedMemory() {
  constexpr int kBytes = 32 << 20;  // the most that glibc takes for the first
  mallopt(M_MMAP_THRESHOLD, kBytes);
  mallopt(M_TRIM_THRESHOLD, kBytes);
}

int simulate(const Arguments& a) {
  if (a.scene.empty() || a.output.empty()) {
    throw std::runtime_error("--scene and --output are needed (or --list)");
  }
  SequenceOptions options;
  options.camera = parseDrift("--camera-drift", a.camera_drift);
  options.object = parseDrift("--object-drift", a.object_drift);
  options.drift_seed = a.drift_seed.value_or(a.seed);
  const sim::Simulator simulator(a.scene, a.seed, a.noise);
  const int end = lastFrame(a, simulator.frames());
  prepareFolder(a.output, a.overwrite);
  SequenceWriter writer(a.output, simulator.world(), options);
  int done = 0;
  for (int k = a.start; k < end && g_stop == 0; ++k) {
    writer.add(simulator.frame(k));
    if (++done % 30 == 0 || k + 1 == end) {
      fmt::print(stderr, "\r{}: frame {} of {}", a.scene, done, end - a.start);
    }
  }
  writer.finish();
  fmt::print(stderr, "\n{}: {} frames in {}\n", g_stop != 0 ? "stopped" : "done", done, a.output);
  return g_stop != 0 ? kExitStopped : 0;
}

}  // namespace
}  // namespace rf

int main(int argc, char** argv) {
  CLI::App app("Writes a simulated RGB-D sequence of a furnished room with exact truth.",
               "rf-simulate");
  rf::Arguments arguments;
  rf::declare(app, arguments);
  CLI11_PARSE(app, argc, argv);
  std::signal(SIGINT, [](int) { rf::g_stop = 1; });
  std::signal(SIGTERM, [](int) { rf::g_stop = 1; });
  try {
    if (arguments.list) {
      rf::printScenes();
      return 0;
    }
    rf::keepFreedMemory();
    rf::setThreads(arguments.threads);
    return rf::simulate(arguments);
  } catch (const std::exception& e) {
    fmt::print(stderr, "rf-simulate: {}\n", e.what());
    return 1;
  }
}
