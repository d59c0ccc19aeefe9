// SPDX-License-Identifier: BSD-3-Clause
#include "simulated_cut.hpp"

#include <utility>

#include "datasets/image_files.hpp"
#include "geometry/parallel.hpp"
#include "priors/simulated_drift.hpp"
#include "simulation/depth_sensor.hpp"

namespace rf {

RgbdFrame shown(const sim::SimulatedFrame& frame) {
  RgbdFrame out;
  out.colour = frame.colour;
  out.depth_mm = depthToMillimetres(frame.depth, sim::kDepthFactor);
  return out;
}

SimulatedCut renderCut(const sim::Simulator& simulator, int first, int count, std::uint64_t seed) {
  SimulatedCut cut;
  setThreads(2);
  for (int k = 0; k < count; ++k) {
    sim::SimulatedFrame f = simulator.frame(first + k);
    RgbdFrame frame = shown(f);
    frame.utime = frame.colour_utime = f.utime;
    frame.seq = k;
    cut.frames.push_back(std::move(frame));
    cut.truth.push_back(std::move(f.mask));
    cut.speed.push_back(f.object_speed_mps);
    cut.camera.push_back({f.utime, f.T_WC});
    if (f.T_WB.size() > 1) cut.object.push_back({f.utime, f.T_WB[1]});
  }
  setThreads(1);
  cut.camera_prior = withDrift(cut.camera, {0.06, 0.4, seed, DriftStream::kCamera});
  // In a world at rest there is no object, and a drift of no poses is refused.
  if (cut.object.empty()) return cut;
  cut.object_prior = withDrift(cut.object, {0.015, 0.1, seed, DriftStream::kObject});
  return cut;
}

std::function<std::optional<RgbdFrame>()> framesOf(const SimulatedCut& cut) {
  return [&cut, at = std::size_t{0}]() mutable -> std::optional<RgbdFrame> {
    if (at == cut.frames.size()) return std::nullopt;
    return cut.frames[at++];
  };
}

}  // namespace rf
