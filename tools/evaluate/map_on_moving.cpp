// SPDX-License-Identifier: BSD-3-Clause
#include "map_on_moving.hpp"

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "datasets/calibration.hpp"
#include "datasets/image_files.hpp"
#include "datasets/ply.hpp"
#include "datasets/tum.hpp"
#include "mask_folder.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;

std::optional<SE3> poseAt(const Trajectory& trajectory, std::int64_t utime) {
  const auto at =
      std::lower_bound(trajectory.begin(), trajectory.end(), utime,
                       [](const StampedPose& p, std::int64_t t) { return p.utime < t; });
  if (at == trajectory.end() || at->utime != utime) return std::nullopt;
  return at->pose;
}

}  // namespace

std::optional<MapOnMoving> scoreMapOnMoving(const std::string& sequence, const std::string& result,
                                            const std::string& truth_masks,
                                            const Trajectory& camera) {
  const std::string model = (fs::path(result) / "static.ply").string();
  const std::string calibration_file = (fs::path(sequence) / "camera.yaml").string();
  const auto masks = listMasks(truth_masks);
  if (masks.empty() || !fs::exists(model) || !fs::exists(calibration_file)) return std::nullopt;
  const Calibration calibration = readCalibration(calibration_file);
  const int width = calibration.camera.width;
  const int height = calibration.camera.height;
  const std::vector<SurfelPoint> map = readPly(model);
  MovingPixels moving(map, calibration.camera);
  for (const TumEntry& entry : indexTumFolder(sequence).frames) {
    const auto mask = masks.find(entry.utime);
    const auto T_WC = poseAt(camera, entry.utime);
    if (mask == masks.end() || !T_WC) continue;
    moving.add({readGreyImage(mask->second, width, height),
                depthToMillimetres(readDepthImage(entry.depth_path, width, height),
                                   calibration.depth_factor),
                *T_WC});
  }
  return moving.result();
}

}  // namespace rf
