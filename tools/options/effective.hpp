// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pipeline/pipeline_config.hpp"
#include "pipeline/prior_stage.hpp"
#include "pipeline/run_options.hpp"
#include "values/frame_source.hpp"

namespace rf {

/// Defaults, then robot.yaml of the robot folder, then --config, --mode and --set. Throws
/// ConfigError.
PipelineConfig effectiveConfig(const RunOptions& options);

/// The prior stage with the trajectories in force, drifted when asked, and the robot. What is to be
/// said of the robot's samples goes to `remarks`. Throws DatasetError, KinematicsError.
PriorStage makePriorStage(const PriorConfig& config, const RunOptions& options,
                          std::vector<std::string>& remarks);

/// Writes the trajectories in force, drifted when asked, as camera_prior.txt and object_prior.txt
/// into the result folder, where rf-evaluate looks for them. Throws DatasetError.
void savePriors(const RunOptions& options);

/// A TUM-layout folder, an LCM log or an .oni recording. Throws DatasetError, ConfigError.
std::unique_ptr<FrameSource> openSource(const RunOptions& options);

}  // namespace rf
