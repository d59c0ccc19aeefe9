// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

#include "pipeline/run_options.hpp"

namespace rf {

/// Adds the options that rf-run and rf-launch share.
void addRunOptions(CLI::App& app, RunOptions& options);

}  // namespace rf
