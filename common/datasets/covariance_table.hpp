// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fstream>
#include <string>

#include "values/model_state.hpp"
#include "values/pose_covariance.hpp"

namespace rf {

/// Writes covariance.csv: one row per frame and body (the object from its birth on), flushed at
/// once. Columns are named in the first row: timestamp (s), body ("camera": T_WC, "object": T_WO),
/// health, and the upper triangle c00, c01 ... c55 row by row of the 6x6 covariance: right
/// perturbation of the pose in frame B, translation first (m^2, m rad, rad^2).
class CovarianceTable {
 public:
  /// Replaces the file. Throws DatasetError.
  explicit CovarianceTable(const std::string& path);
  void add(const ModelState& state);

 private:
  void write(const std::string& row);
  std::string path_;
  std::ofstream file_;
};

/// The rows of both bodies of covariance.csv.
struct CovarianceFile {
  PoseCovariances camera;
  PoseCovariances object;
};

/// Reads covariance.csv. Throws DatasetError naming file and line for a word that is not what its
/// column says, and for time that does not increase.
CovarianceFile readCovariances(const std::string& path);

}  // namespace rf
