// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "priors/drift.hpp"
#include "simulation/simulator.hpp"
#include "simulation/surface_samples.hpp"

namespace rf {

/// Mean drift of a written prior; absent: no prior is written.
struct PriorDrift {
  double translation_mps;
  double rotation_radps;
};

struct SequenceOptions {
  std::optional<PriorDrift> camera;
  std::optional<PriorDrift> object;
  std::uint64_t drift_seed = 0;
};

/// Writes simulated frames as a folder in the TUM layout with truth beside it (docs/SIMULATION.md).
/// Images go to disk as they come; the lists, poses, priors and surfaces with finish(), so that a
/// stop after any frame leaves a valid, shorter sequence. Every failure throws std::runtime_error
/// that names the file.
class SequenceWriter {
 public:
  SequenceWriter(std::filesystem::path folder, const sim::World& world, SequenceOptions options);
  void add(const sim::SimulatedFrame& frame);
  void finish();

 private:
  void writeLists() const;
  void writePoses() const;
  void writePriors() const;
  void writeSurfaces() const;

  struct Entry {
    std::int64_t utime;
    SE3 T_WC;
    std::vector<SE3> T_WB;
    double object_speed;
    double object_share;  ///< of the valid pixels
    double valid_share;   ///< of all pixels
  };
  std::filesystem::path folder_;
  const sim::World& world_;
  SequenceOptions options_;
  sim::SurfaceSamples samples_;
  std::vector<Entry> entries_;
};

}  // namespace rf
