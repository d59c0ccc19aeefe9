// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluation/consistency.hpp"
#include "evaluation/model_error.hpp"
#include "evaluation/moving_pixels.hpp"
#include "evaluation/per_frame.hpp"
#include "evaluation/segmentation_score.hpp"
#include "evaluation/trajectory_error.hpp"

namespace rf {

/// Everything that could be measured of one result; what could not is absent, with a note saying
/// why.
struct EvaluationReport {
  std::optional<TrajectoryScore> camera;
  std::optional<TrajectoryScore> camera_prior;
  std::optional<TrajectoryScore> object;
  std::optional<TrajectoryScore> object_prior;
  std::optional<Consistency> camera_consistency;
  std::optional<Consistency> object_consistency;
  double speed_threshold = 0.03;            ///< m/s
  std::optional<SegmentationScore> fast;    ///< frames with the object above the threshold
  std::optional<SegmentationScore> moving;  ///< frames in which it moves at all
  std::optional<PixelCounts> self;          ///< of all frames, when truth knows the robot's pixels
  std::optional<ModelScore> static_model;
  std::optional<ModelScore> object_model;
  std::optional<MapOnMoving> static_on_moving;  ///< where there is no true surface
  std::vector<std::string> notes;
  std::vector<FrameScore> each_frame;  ///< when asked for; not part of the texts below
};

/// A table for people: ATE in cm, RPE in cm/s and deg/s.
std::string toText(const EvaluationReport& report);
/// One JSON object; what is absent is null. Units are in the keys.
std::string toJson(const EvaluationReport& report);

}  // namespace rf
