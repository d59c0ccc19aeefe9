// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "geometry/camera.hpp"
#include "geometry/image.hpp"
#include "mapping/fusion_config.hpp"
#include "mapping/sensor_model.hpp"

namespace rf {

/// One frame as fusion needs it, at model resolution, all planes of the camera's size.
struct FrameMaps {
  Camera camera;
  Image<float> depth;           ///< metres, 0 = none
  Image<Rgb> colour;            ///< mean of the input block
  Image<float> nx, ny, nz;      ///< unit normal from filtered depth, facing the camera; nz 0 = none
  Image<float> farthest_clear;  ///< nearest depth of the 3x3 around, 0 where fewer than 6 are
                                ///< valid: the space before it is free for the whole pixel
};

/// Sets depths outside the sensor's range, and anything not finite, to 0.
void limitDepth(const SensorConfig& sensor, Image<float>& depth);

/// Edge-preserving mean over 5x5 pixels; weights fall to 0 at depth differences of a few sigma.
Image<float> smoothDepth(const Image<float>& depth, const SensorModel& sensor);

/// Normals by central differences (paper section V after ElasticFusion); none where a neighbour is
/// missing or lies across a depth edge.
void computeNormals(const Image<float>& smooth_depth, FrameMaps& maps);

/// Nearest valid depth of the 3x3 around each pixel, 0 where fewer than 6 of the 9 are valid.
Image<float> nearestAround(const Image<float>& depth);

/// Means over blocks of reduction x reduction pixels; sizes round down.
Image<Rgb> reduceColour(const Image<Rgb>& colour, int reduction);

/// All maps of a frame. `depth` (metres, 0 = none) and `colour` have the camera's size.
FrameMaps makeFrameMaps(const Camera& camera, const Image<float>& depth, Image<Rgb> colour,
                        const SensorConfig& sensor);

/// How much of each pixel belongs to one body, 0..1.
struct BodyWeights {
  Image<float> own;              ///< weight in tracking and fusion
  Image<std::uint8_t> interior;  ///< 1 where the whole 3x3 with depth belongs to the body
};

/// Splits a segmentation score (255 * gamma at the maps' size) into the weights of the static body
/// and of the object. Pixels near a border of the mask get less, by the share of their own class
/// among the pixels with depth in the 5x5 around, so that a mask wrong by a pixel or two does
/// little harm.
struct SplitWeights {
  BodyWeights world;
  BodyWeights object;
};
SplitWeights splitWeights(const Image<std::uint8_t>& score, const Image<float>& depth);

}  // namespace rf
