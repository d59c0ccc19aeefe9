// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/simulator.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/parallel.hpp"
#include "simulation/colour_camera.hpp"
#include "simulation/random.hpp"
#include "simulation/shading.hpp"

namespace rf::sim {
namespace {

double speedOf(const World& world, double seconds) {
  if (world.body_at.empty()) return 0;
  const double h = 0.5 / kFrameRate;
  return (world.body_at[0](seconds + h).t - world.body_at[0](seconds - h).t).norm() / (2 * h);
}

std::vector<SE3> bodiesInCamera(const World& world, double seconds) {
  std::vector<SE3> poses = bodyPoses(world, seconds);
  const SE3 T_CW = world.camera_at(seconds).inverse();
  for (SE3& pose : poses) pose = T_CW * pose;
  return poses;
}

}  // namespace

Simulator::Simulator(const std::string& scene, std::uint64_t seed, double noise)
    : seed_(seed),
      noise_(static_cast<float>(noise)),
      world_(buildWorld(scene, seed)),
      lamps_(world_),
      baked_(world_, lamps_) {
  if (!(noise >= 0 && std::isfinite(noise))) {
    throw std::invalid_argument("noise factor: must be finite and not negative");
  }
}

std::int64_t Simulator::utime(int k) {
  return kStartUtime + (static_cast<std::int64_t>(k) * 1'000'000 + 15) / 30;
}

SimulatedFrame Simulator::frame(int k) const {
  const double seconds = k / kFrameRate;
  SimulatedFrame out;
  out.utime = utime(k);
  out.T_WC = world_.camera_at(seconds);
  out.T_WB = bodyPoses(world_, seconds);
  out.object_speed_mps = speedOf(world_, seconds);
  const std::uint64_t key = scramble(seed_, 0xF4A3E000ULL + static_cast<std::uint64_t>(k));
  const Raycaster caster(world_, out.T_WB, out.T_WC);
  const SurfaceImage surface = caster.castAll();
  Shaded shaded = shade(world_, lamps_, baked_, caster, surface, out.T_WB, out.T_WC);
  DepthOutput depth = senseDepth({surface.z, std::move(shaded.cosine), std::move(shaded.infrared),
                                  std::move(shaded.body), firstRobotBody(world_)},
                                 world_.camera, scramble(key, 1), noise_);
  out.depth = std::move(depth.depth);
  out.mask = std::move(depth.mask);
  const Image<Eigen::Vector2f> flow = shutterFlow(world_, surface, bodiesInCamera(world_, seconds),
                                                  bodiesInCamera(world_, seconds - 0.5 * kShutter),
                                                  bodiesInCamera(world_, seconds + 0.5 * kShutter));
  const Image<Eigen::Vector3f> light = blurred(shaded.light, flow);
  ColourResponse response = responseAt(k, seed_, light);
  response.noise *= noise_;
  out.colour = develop(light, response, scramble(key, 2));
  out.true_z = surface.z;
  return out;
}

}  // namespace rf::sim
