// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pipeline/run_options.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): theirs
class App;
}

namespace rf {

/// Adds the options that rf-run and rf-launch share.
void addRunOptions(CLI::App& app, RunOptions& options);

}  // namespace rf
