// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/yaml.hpp"
#include "messaging/service.hpp"
#include "pipeline/pipeline_config.hpp"

namespace rf {

/// Defaults (or what is given for them), then --config, then --set. Throws ConfigError naming file,
/// field, value and rule.
inline PipelineConfig serviceConfig(const ServiceOptions& options, PipelineConfig config = {}) {
  if (!options.config.empty()) loadConfigFile(options.config, config);
  for (const std::string& assignment : options.set) overrideConfig(assignment, config);
  checkConfig(config, "configuration");
  return config;
}

}  // namespace rf
