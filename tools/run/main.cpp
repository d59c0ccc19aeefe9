// SPDX-License-Identifier: BSD-3-Clause
// rf-run: the whole pipeline in one process, offline.
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "config/yaml.hpp"
#include "datasets/result_writer.hpp"
#include "datasets/trajectory.hpp"
#include "geometry/parallel.hpp"
#include "kinematics/error.hpp"
#include "options/effective.hpp"
#include "options/run_cli.hpp"
#include "pipeline/offline.hpp"

namespace {

volatile std::sig_atomic_t g_stop = 0;
void onSignal(int) { g_stop = 1; }

constexpr int kExitStopped = 0;
constexpr int kExitBadConfig = 2;
constexpr int kExitNoInput = 4;

void progress(std::size_t done, std::size_t total, const rf::OfflinePipeline::Output& out) {
  fmt::print(stderr, "\r{:>5}/{}  camera {:<10}  object {:<10}  dynamic {:4.0f} %  {:<16}", done,
             total, rf::name(out.state.camera.health),
             out.state.object_exists ? rf::name(out.state.object.health) : "unborn",
             100 * out.segmentation.dynamic_share, out.segmentation.hypothesis);
}

/// The next frame of the recording, read and prepared while the one before is still in the
/// pipeline. What went wrong is for its own turn.
struct Ahead {
  std::optional<rf::SourcedFrame> input;  ///< nothing: the recording is over
  std::optional<rf::OfflinePipeline::Input> prepared;
  std::exception_ptr error;
};

Ahead readAhead(rf::FrameSource& source, rf::OfflinePipeline& pipeline) {
  Ahead out;
  try {
    out.input = source.next();
    if (out.input && out.input->frame) {
      out.prepared = pipeline.prepare(*out.input->frame, out.input->coded);
    }
  } catch (...) {
    out.error = std::current_exception();
  }
  return out;
}

int run(const rf::RunOptions& options) {
  rf::setThreads(options.threads);
  const rf::PipelineConfig config = rf::effectiveConfig(options);
  const std::unique_ptr<rf::FrameSource> source = rf::openSource(options);
  std::vector<std::string> remarks;
  rf::OfflinePipeline pipeline(config, source->camera(),
                               rf::makePriorStage(config.prior, options, remarks));
  for (const std::string& remark : remarks) fmt::print(stderr, "rf-run: {}\n", remark);
  rf::ResultWriter writer(
      options.output, source->camera(),
      {options.write_masks, rf::writeConfig(config), config.fusion.object.false_birth_frames});
  std::size_t done = 0;
  Ahead next = readAhead(*source, pipeline);
  while (g_stop == 0) {
    Ahead now = std::exchange(next, {});
    if (now.error) std::rethrow_exception(now.error);
    if (!now.input) break;
    ++done;
    if (!now.prepared) {
      fmt::print(stderr, "\n{}\n", now.input->problem);
      writer.addLost(now.input->utime, now.input->seq, now.input->problem);
      next = readAhead(*source, pipeline);
      continue;
    }
    rf::OfflinePipeline::Output out;
    rf::parallelCalls({[&] { out = pipeline.process(std::move(*now.prepared)); },
                       [&] { next = readAhead(*source, pipeline); }});
    writer.addPrior(out.prior);
    writer.add(out.frame, out.segmentation, out.state);
    if (!options.quiet) progress(done, source->size(), out);
  }
  writer.writeModels(pipeline.fusion().surfels(rf::kBodyStatic),
                     pipeline.fusion().surfels(rf::kBodyObject));
  if (!options.quiet) {
    fmt::print(stderr, "\n{} frames, {} lost; results in {}\n", writer.framesWritten(),
               writer.framesLost(), options.output);
  }
  return kExitStopped;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "rf-run: segment, track and reconstruct a recording in one process.\n"
      "Exit codes: 0 done or stopped, 2 bad options or configuration, 4 input unusable.");
  rf::RunOptions options;
  rf::addRunOptions(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitStopped : kExitBadConfig;
  }
  if (const std::string problem = options.problem(); !problem.empty()) {
    fmt::print(stderr, "rf-run: {}\n", problem);
    return kExitBadConfig;
  }
  std::signal(SIGINT, onSignal);
  std::signal(SIGTERM, onSignal);
  try {
    return run(options);
  } catch (const rf::ConfigError& error) {
    fmt::print(stderr, "rf-run: {}\n", error.what());
    return kExitBadConfig;
  } catch (const rf::KinematicsError& error) {
    fmt::print(stderr, "rf-run: {}\n", error.what());
    return kExitBadConfig;
  } catch (const std::exception& error) {
    fmt::print(stderr, "rf-run: {}\n", error.what());
    return kExitNoInput;
  }
}
