// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/frame_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "datasets/error.hpp"

namespace rf {
namespace {

constexpr const char* kHeader =
    "utime,seq,health,object_health,object_exists,object_resting,object_moving,hypothesis,"
    "dynamic_share,segment_static_rms,segment_static_inliers,segment_object_rms,"
    "segment_object_inliers,track_static_rms_m,track_static_inliers,track_object_rms_m,"
    "track_object_inliers,static_surfels,object_surfels,segment_ms,fuse_ms,stage_ms,note";

constexpr double kSelfBehindNoted = 0.1;

/// Keeps a free text inside one cell.
std::string cell(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == ',' || c == '\n' || c == '"'; }, ' ');
  return text;
}

double total(const StageTimes& times) {
  double sum = 0;
  for (const auto& [stage, ms] : times) sum += ms;
  return sum;
}

std::string list(const StageTimes& segment, const StageTimes& fuse) {
  std::string text;
  for (const auto& [prefix, times] : {std::pair{"segment.", &segment}, std::pair{"fuse.", &fuse}}) {
    for (const auto& [stage, ms] : *times) {
      if (!text.empty()) text += ';';
      text += fmt::format("{}{}={:.3f}", prefix, cell(stage), ms);
    }
  }
  return text;
}

/// Something is wrong with the robot's description or joints when much of it is not seen.
std::string noteOf(const SegmentationResult& s) {
  if (s.self_behind < kSelfBehindNoted) return {};
  return fmt::format("{:.0f} % of the robot is not where its shapes and joints say",
                     100 * s.self_behind);
}

}  // namespace

FrameTable::FrameTable(const std::string& path) : path_(path), file_(path, std::ios::trunc) {
  if (!file_) throw DatasetError(path + ": cannot be opened for writing");
  write(kHeader);
}

void FrameTable::write(const std::string& row) {
  file_ << row << '\n' << std::flush;
  if (!file_) throw DatasetError(path_ + ": cannot be written");
}

void FrameTable::add(const SegmentationResult& s, const ModelState& m) {
  std::string row = fmt::format("{},{},{},{},{:d},{:d},{:d},{}", m.utime, m.seq,
                                name(m.camera.health), name(m.object.health), m.object_exists,
                                m.object_resting, s.object_moving, cell(s.hypothesis));
  row += fmt::format(",{:.6f},{:.6f},{:.1f},{:.6f},{:.1f}", s.dynamic_share, s.camera.rms_residual,
                     s.camera.inliers, s.object.rms_residual, s.object.inliers);
  row += fmt::format(",{:.6f},{:.1f},{:.6f},{:.1f},{},{}", m.camera.rms_residual, m.camera.inliers,
                     m.object.rms_residual, m.object.inliers, m.static_surfels, m.object_surfels);
  row += fmt::format(",{:.3f},{:.3f},{},{}", total(s.stage_ms), total(m.stage_ms),
                     list(s.stage_ms, m.stage_ms), noteOf(s));
  write(row);
}

void FrameTable::addLost(std::int64_t utime, std::int64_t seq, const std::string& reason) {
  // 23 columns: three given, nineteen empty, the note.
  write(fmt::format("{},{},{}{}{}", utime, seq, name(Health::kLost), std::string(20, ','),
                    cell(reason)));
}

}  // namespace rf
