// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/result_writer.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

#include "datasets/error.hpp"
#include "datasets/image_files.hpp"
#include "datasets/ply.hpp"
#include "datasets/text.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;

std::string in(const std::string& folder, const char* name) {
  return (fs::path(folder) / name).string();
}

void removeOldMasks(const fs::path& masks) {
  if (!fs::is_directory(masks)) return;
  std::vector<fs::path> old;
  for (const fs::directory_entry& entry : fs::directory_iterator(masks)) {
    const fs::path& path = entry.path();
    if (path.extension() == ".png" && parseTimestamp(path.stem().string())) old.push_back(path);
  }
  for (const fs::path& path : old) fs::remove(path);
}

/// The folder, empty of earlier results.
const std::string& prepared(const std::string& folder, bool write_masks) {
  try {
    fs::create_directories(folder);
    const fs::path masks = fs::path(folder) / "masks";
    removeOldMasks(masks);
    if (write_masks) fs::create_directories(masks);
    for (const char* file : {"static.ply", "object.ply", "camera_prior.txt", "object_prior.txt"}) {
      fs::remove(fs::path(folder) / file);
    }
  } catch (const fs::filesystem_error& e) {
    throw DatasetError(folder + ": cannot be prepared for results: " + e.code().message());
  }
  return folder;
}

bool isKnown(Health health) { return health != Health::kLost && health != Health::kInvalid; }

/// Where the prior's sources alone put the object. A camera-kind pose needs that of the camera.
std::optional<SE3> objectInWorld(const MotionPrior& prior) {
  if (prior.object == PriorState::kMissing) return std::nullopt;
  if (prior.object_kind == ObjectPriorKind::kWorldFrame) return prior.T_XOb;
  if (prior.object_kind != ObjectPriorKind::kCameraFrame) return std::nullopt;
  if (prior.camera == PriorState::kMissing) return std::nullopt;
  return prior.T_WCb * prior.T_XOb;
}

}  // namespace

ResultWriter::ResultWriter(const std::string& folder, const Camera& camera, const Options& options)
    : folder_(prepared(folder, options.write_masks)),
      mask_maker_(camera),
      write_masks_(options.write_masks),
      camera_(in(folder, "camera.txt"), "T_WC: timestamp tx ty tz qx qy qz qw"),
      object_(in(folder, "object.txt"), "T_WO: timestamp tx ty tz qx qy qz qw"),
      newborn_(options.newborn_frames),
      frames_(in(folder, "frames.csv")),
      covariances_(in(folder, "covariance.csv")) {
  std::ofstream config(in(folder, "config.yaml"), std::ios::trunc);
  config << options.config_yaml << std::flush;
  if (!config) throw DatasetError(in(folder, "config.yaml") + ": cannot be written");
}

ResultWriter::~ResultWriter() {
  try {
    for (const StampedPose& T_WO : newborn_.rest()) object_.add(T_WO.utime, T_WO.pose);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
  }
}

void ResultWriter::add(const RgbdFrame& frame, const SegmentationResult& segmentation,
                       const ModelState& state) {
  if (frame.utime != segmentation.utime || frame.utime != state.utime) {
    throw std::invalid_argument(fmt::format("results of different frames: utime {}, {} and {}",
                                            frame.utime, segmentation.utime, state.utime));
  }
  if (isKnown(state.camera.health)) camera_.add(state.utime, state.camera.T_W);
  addObject(state);
  if (write_masks_) {
    const std::string file = formatTimestamp(frame.utime) + ".png";
    writeGreyImage((fs::path(folder_) / "masks" / file).string(),
                   mask_maker_.make(frame.depth_mm, segmentation.score, segmentation.label,
                                    segmentation.reduction));
  }
  frames_.add(segmentation, state);
  covariances_.add(state);
  ++frames_written_;
}

void ResultWriter::addObject(const ModelState& state) {
  if (!state.object_exists) newborn_.gone();
  if (!state.object_exists || !isKnown(state.object.health)) return;
  for (const StampedPose& T_WO : newborn_.add({state.utime, state.object.T_W})) {
    object_.add(T_WO.utime, T_WO.pose);
  }
}

void ResultWriter::addPrior(const MotionPrior& prior) {
  if (prior.camera != PriorState::kMissing) {
    if (!camera_prior_) camera_prior_.emplace(in(folder_, "camera_prior.txt"), "prior T_WC");
    camera_prior_->add(prior.utime_b, prior.T_WCb);
  }
  if (const std::optional<SE3> T_WO = objectInWorld(prior)) {
    if (!object_prior_) object_prior_.emplace(in(folder_, "object_prior.txt"), "prior T_WO");
    object_prior_->add(prior.utime_b, *T_WO);
  }
}

void ResultWriter::addLost(std::int64_t utime, std::int64_t seq, const std::string& reason) {
  frames_.addLost(utime, seq, reason);
  ++frames_lost_;
}

void ResultWriter::writeModels(const std::vector<SurfelPoint>& static_surfels,
                               const std::vector<SurfelPoint>& object_surfels) const {
  writePly(in(folder_, "static.ply"), static_surfels);
  writePly(in(folder_, "object.ply"), object_surfels);
}

}  // namespace rf
