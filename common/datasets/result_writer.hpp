// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/covariance_table.hpp"
#include "datasets/frame_table.hpp"
#include "datasets/mask_maker.hpp"
#include "datasets/newborn_poses.hpp"
#include "datasets/trajectory.hpp"
#include "values/frame.hpp"
#include "values/motion_prior.hpp"
#include "values/surfel_point.hpp"

namespace rf {

/// Writes a result folder as the frames come: camera.txt, object.txt, frames.csv,
/// covariance.csv, masks/, at the end static.ply and object.ply, and config.yaml. Every file but
/// the PLYs is complete after each call, but object.txt lacks a body's first poses until it is
/// known to be no false alarm.
class ResultWriter {
 public:
  struct Options {
    bool write_masks = false;
    std::string config_yaml;  ///< the effective configuration, written as config.yaml
    int newborn_frames = 0;   ///< poses of a new body that wait: fusion.object.false_birth_frames
  };

  /// Makes the folder. Results of an earlier run in it are removed (only files of the names above;
  /// in masks/ only <timestamp>.png). Throws DatasetError.
  ResultWriter(const std::string& folder, const Camera& camera, const Options& options);
  /// Writes the poses that still wait.
  ~ResultWriter();
  ResultWriter(const ResultWriter&) = delete;
  ResultWriter& operator=(const ResultWriter&) = delete;

  /// Takes one frame's results. camera.txt gets a line unless the camera is lost; object.txt from
  /// the object's birth on unless the object is lost, but not of an object that is gone within its
  /// first Options::newborn_frames; frames.csv and covariance.csv always. Throws
  /// std::invalid_argument when the three are not of one frame, DatasetError when a file fails.
  void add(const RgbdFrame& frame, const SegmentationResult& segmentation, const ModelState& state);

  /// Keeps the prior that was used, as the source gave it: camera_prior.txt (T_WC) and
  /// object_prior.txt (T_WO; of the camera kind T_WC T_CO, what the kinematics alone say), so that
  /// results can be compared with it. The files appear with the first prior that is not missing.
  void addPrior(const MotionPrior& prior);

  /// An input frame without a result (unreadable image, dropped message): a row in frames.csv.
  void addLost(std::int64_t utime, std::int64_t seq, const std::string& reason);

  /// Writes static.ply and object.ply; may be called again with newer models.
  void writeModels(const std::vector<SurfelPoint>& static_surfels,
                   const std::vector<SurfelPoint>& object_surfels) const;

  std::int64_t framesWritten() const { return frames_written_; }
  std::int64_t framesLost() const { return frames_lost_; }

 private:
  void addObject(const ModelState& state);

  std::string folder_;
  MaskMaker mask_maker_;
  bool write_masks_ = false;
  TrajectoryWriter camera_;
  TrajectoryWriter object_;
  NewbornPoses newborn_;
  std::optional<TrajectoryWriter> camera_prior_;
  std::optional<TrajectoryWriter> object_prior_;
  FrameTable frames_;
  CovarianceTable covariances_;
  std::int64_t frames_written_ = 0;
  std::int64_t frames_lost_ = 0;
};

}  // namespace rf
