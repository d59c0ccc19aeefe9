// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "geometry/camera.hpp"
#include "simulation/shapes.hpp"
#include "simulation/texture.hpp"

namespace rf::sim {

struct Manipulator;

/// How a surface looks, to the eye and to the infrared depth sensor.
struct Material {
  int texture = -1;                                  ///< index into World::textures; -1 plain
  bool fit = false;                                  ///< the picture fills the face, else it tiles
  float metres_per_texel = 0.002F;                   ///< of a tiling picture
  Eigen::Vector2f offset = Eigen::Vector2f::Zero();  ///< of a tiling picture, texels
  Eigen::Vector3f tint = Eigen::Vector3f::Ones();    ///< linear albedo (times the picture)
  float infrared = 0.6F;  ///< how much of the projector's pattern comes back, 0..1
  float gloss = 0.0F;     ///< strength of the lamps' mirror image, 0..1
  float glow = 0.0F;      ///< light of its own, relative to a white wall's
};

/// A rectangular lamp in the ceiling, shining down.
struct Lamp {
  Vec3 centre_W;
  Vec3 half;                                        ///< half extents, metres (z unused)
  Eigen::Vector3f power = Eigen::Vector3f::Ones();  ///< linear colour and strength
};

/// A room with its things and how the camera and the bodies move in it. World frame W: z up, origin
/// on the floor in the middle of the room. Every body's frame stands on the floor below its middle.
struct World {
  Camera camera;
  int frames = 0;  ///< of the whole choreography, at kFrameRate
  int bodies = 1;  ///< the static world and the moving bodies
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Primitive> primitives;
  std::vector<Lamp> lamps;
  std::function<SE3(double)> camera_at;             ///< T_WC at a time in seconds
  std::vector<std::function<SE3(double)>> body_at;  ///< T_WB of bodies 1.., index body - 1
  std::shared_ptr<const Manipulator> robot;         ///< what carries camera and body 1, or null
};

inline constexpr double kFrameRate = 30.0;

/// One scene of the list.
struct SceneInfo {
  std::string name;
  int frames;
  std::string summary;
};

const std::vector<SceneInfo>& scenes();

/// Builds a scene. The seed changes decor, textures and layout, not the choreography. Throws
/// std::invalid_argument for an unknown name, listing the known ones.
World buildWorld(const std::string& scene, std::uint64_t seed);

/// The first body that is a link of the world's robot; `bodies` when it has none.
int firstRobotBody(const World& world);

/// T_WB of every body at a time; the first is the static world's identity.
std::vector<SE3> bodyPoses(const World& world, double seconds);

}  // namespace rf::sim
