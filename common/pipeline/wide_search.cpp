// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/wide_search.hpp"

#include <cstddef>

namespace rf {

Image<float> everywhere(const Image<float>& depth) {
  Image<float> out(depth.width(), depth.height());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = depth[i] > 0 ? 1.0F : 0.0F;
  return out;
}

FusionConfig wideSearch(FusionConfig c) {
  TrackingConfig& t = c.tracking;
  t.coarse_distance = 2.5;
  t.iterations_coarse = 20;
  t.iterations_fine = 10;
  t.max_shift_m *= kWideShift;
  t.max_turn_rad *= kWideTurn;
  t.sure_inliers = 1.0;  // nothing is sure here
  t.max_rms_sigma *= 0.7;
  return c;
}

}  // namespace rf
