// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/se3.hpp"
#include "values/surfel_point.hpp"

namespace rf {

/// How well a reconstructed surface covers a true one.
struct ModelScore {
  std::size_t model_points = 0;
  std::size_t truth_points = 0;
  double accuracy_median = 0;  ///< metres, of model points to the true surface
  double accuracy_rmse = 0;    ///< metres, over the model points within 10 cm
  double accuracy_share = 0;   ///< of the model points: within `limit` of the true surface
  double completeness = 0;     ///< share of the true points that have a model point within `limit`
};

/// Distance of a model point to the true surface: to the tangent plane of the nearest true sample
/// where that has a normal and lies at most 2 cm aside, else to the sample itself (samples are
/// about 1 cm apart, so distances to samples alone would be too large). Distances are cut at 0.5 m.
/// `T_truth_model` brings model coordinates into the truth's frame.
ModelScore scoreModel(const std::vector<SurfelPoint>& model, const std::vector<SurfelPoint>& truth,
                      const SE3& T_truth_model, double limit = 0.02);

}  // namespace rf
