// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluation/report.hpp"

namespace rf {

/// What is compared with what.
struct EvaluationRequest {
  std::string sequence;           ///< folder with the truth
  std::string result;             ///< result folder
  std::string camera_prior;       ///< file, "none", or empty: the result's, else the sequence's
  std::string object_prior;       ///< the same
  std::string truth_masks;        ///< folder, or empty: mask/, else masks_hand/ of the sequence
  double speed_threshold = 0.03;  ///< m/s
  bool each_frame = false;        ///< fill each_frame of the report too
};

/// Measures what the folders allow; what is absent is left out with a note. Throws DatasetError for
/// files that are there but unusable, and when the sequence or camera.txt is not there.
EvaluationReport evaluateFolders(const EvaluationRequest& request);

}  // namespace rf
