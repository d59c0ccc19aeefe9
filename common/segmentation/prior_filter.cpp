// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/prior_filter.hpp"

#include <algorithm>
#include <cmath>

namespace rf {
namespace {

constexpr double kGateSigma = 6.4;  // two increments of equal spread: 4.5 sigma of their difference
constexpr double kGateFloor = 0.003;  // metres and radians: acceleration within a frame

double largestSigma(const Mat6& covariance, int at) {
  return std::sqrt(std::max(0.0, covariance.diagonal().segment<3>(at).maxCoeff()));
}

bool close(const SE3& a, const SE3& b, double gate_m, double gate_rad) {
  const Vec6 difference = (a.inverse() * b).log();
  return difference.head<3>().norm() <= gate_m && difference.tail<3>().norm() <= gate_rad;
}

}  // namespace

Mat6 covarianceOf(const VelocitySpread& spread) {
  Mat6 c = Mat6::Zero();
  c.diagonal().head<3>().setConstant(spread.translation_m * spread.translation_m);
  c.diagonal().tail<3>().setConstant(spread.rotation_rad * spread.rotation_rad);
  return c;
}

Increment PriorFilter::accept(const std::optional<SE3>& prior, const Mat6& covariance,
                              const std::optional<SE3>& last_estimate) {
  Increment out;
  if (prior) {
    const double gate_m = kGateSigma * largestSigma(covariance, 0) + kGateFloor;
    const double gate_rad = kGateSigma * largestSigma(covariance, 3) + kGateFloor;
    const bool near_accepted = !last_accepted_ || close(*last_accepted_, *prior, gate_m, gate_rad);
    const bool near_estimate = last_estimate && close(*last_estimate, *prior, gate_m, gate_rad);
    if (near_accepted || near_estimate) {
      out.T = *prior;
      out.covariance = covariance;
      out.measured = true;
      last_accepted_ = prior;
      return out;
    }
    out.rejected = true;
  }
  out.T = last_estimate.value_or(SE3());
  out.covariance = covarianceOf(spread_);
  if (!last_estimate) out.covariance *= 25.0;  // nothing known: from rest to 0.6 m/s, 1.5 rad/s
  return out;
}

Increment compose(const Increment& ab, const Increment& bc) {
  Increment out;
  out.T = ab.T * bc.T;
  out.measured = ab.measured && bc.measured;
  out.rejected = ab.rejected || bc.rejected;
  out.covariance = Mat6::Zero();
  for (int i = 0; i < 3; ++i) {
    const double sigma = std::sqrt(ab.covariance(i, i)) + std::sqrt(bc.covariance(i, i));
    out.covariance(i, i) = sigma * sigma;
    out.covariance(i + 3, i + 3) = ab.covariance(i + 3, i + 3) + bc.covariance(i + 3, i + 3);
  }
  return out;
}

}  // namespace rf
