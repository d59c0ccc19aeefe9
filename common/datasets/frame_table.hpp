// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "values/model_state.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// Writes frames.csv: one row per input frame, flushed at once. Columns are named in the first row;
/// `stage_ms` lists every stage of both programs as name=milliseconds, separated by ';'.
class FrameTable {
 public:
  /// Replaces the file. Throws DatasetError.
  explicit FrameTable(const std::string& path);
  void add(const SegmentationResult& segmentation, const ModelState& state);
  /// A frame without a result: health "lost" and the reason in the `note` column.
  void addLost(std::int64_t utime, std::int64_t seq, const std::string& reason);

 private:
  void write(const std::string& row);
  std::string path_;
  std::ofstream file_;
};

}  // namespace rf
