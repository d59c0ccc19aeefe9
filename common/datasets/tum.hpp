// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "datasets/calibration.hpp"
#include "values/frame.hpp"

namespace rf {

/// One RGB-D frame of a folder, not yet read.
struct TumEntry {
  std::int64_t utime = 0;  ///< microseconds, the depth image's
  std::int64_t colour_utime = 0;
  std::string colour_path;
  std::string depth_path;
};

/// Which depth image goes with which colour image.
struct TumIndex {
  std::vector<TumEntry> frames;  ///< strictly increasing utime
  std::size_t depth_without_colour = 0;
  std::size_t colour_without_depth = 0;
  std::size_t dropped_lines = 0;      ///< time repeated or unreadable
  std::vector<std::string> warnings;  ///< one text per dropped line
};

/// Largest distance in time of a colour image from its depth image, microseconds.
inline constexpr std::int64_t kAssociationUs = 20000;

/// An image file of a list with its time.
struct TumImage {
  std::int64_t utime = 0;
  std::string path;
};

/// Pairs each depth image with the nearest colour image at most `max_difference_us` away,
/// one-to-one: the closest pairs are made first, ties by the earlier image. Inputs in increasing
/// utime.
TumIndex associate(const std::vector<TumImage>& depth, const std::vector<TumImage>& colour,
                   std::int64_t max_difference_us = kAssociationUs);

/// Index of a folder in TUM layout: from rgb.txt and depth.txt, else from an association file
/// (associated.txt, associations.txt, rgbd_assoc.txt or assoc.txt: `time file time file`, colour or
/// depth first). Throws DatasetError when the folder has neither or a list is unusable.
TumIndex indexTumFolder(const std::string& folder);

/// Reads the frames of a folder in TUM layout. Distinct frames may be loaded from distinct threads.
class TumDataset {
 public:
  /// Calibration from camera.yaml in the folder unless given. Throws DatasetError, ConfigError.
  explicit TumDataset(const std::string& folder,
                      const std::optional<Calibration>& calibration = std::nullopt);

  const Calibration& calibration() const { return calibration_; }
  const TumIndex& index() const { return index_; }
  std::size_t size() const { return index_.frames.size(); }

  struct Loaded {
    std::optional<RgbdFrame> frame;  ///< nothing when an image is unusable
    std::string problem;             ///< then names the file and what is wrong
  };
  /// Frame i with seq = i, so that an unusable frame leaves a gap in seq. Never throws for what is
  /// in the files. Memory is bounded by the calibration's image size.
  Loaded load(std::size_t i) const;

 private:
  Calibration calibration_;
  TumIndex index_;
};

}  // namespace rf
