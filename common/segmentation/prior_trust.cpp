// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation/prior_trust.hpp"

#include <algorithm>
#include <cmath>

namespace rf {

void PriorTrust::observe(const Increment& prior, const SE3& pose, bool follows) {
  if (!follows || !prior.measured) steps_.clear();
  steps_.push_back({prior, pose});
  const auto span = static_cast<std::size_t>(params_.span);
  const std::size_t least = start_ == Start::kWord ? span : (span + 1) / 2;
  if (steps_.size() <= least) return;
  Increment sum{SE3(), Mat6::Zero(), true, false};
  for (std::size_t i = 1; i < steps_.size(); ++i) sum = compose(sum, steps_[i].prior);
  const SE3 tracked = steps_.front().pose.inverse() * steps_.back().pose;
  const Vec6 nu = (sum.T.inverse() * tracked).log();
  const Vec6 variance = sum.covariance.diagonal();
  const double expected_m = variance.head<3>().sum() + 3 * params_.noise_m * params_.noise_m;
  const double expected_rad = variance.tail<3>().sum() + 3 * params_.noise_rad * params_.noise_rad;
  weighed_ = std::min(weighed_ + 1, params_.memory);
  average(nu.head<3>().squaredNorm() / expected_m, square_m_);
  average(nu.tail<3>().squaredNorm() / expected_rad, square_rad_);
  if (steps_.size() > span) steps_.pop_front();
}

void PriorTrust::average(double innovation, double& square) const {
  const double counted = std::min(innovation, params_.clip * std::max(1.0, square));
  const double least = start_ == Start::kWord ? 1.0 : 0.0;
  square = std::clamp(square + (counted - square) / weighed_, least, params_.most);
}

double PriorTrust::factor(double square) const {
  return params_.adapt ? std::max(1.0, std::min(square, 1.5 * square - 2.0)) : 1.0;
}

Mat6 PriorTrust::adapted(const Mat6& covariance) const {
  Vec6 scale;
  scale.head<3>().setConstant(std::sqrt(translationFactor()));
  scale.tail<3>().setConstant(std::sqrt(rotationFactor()));
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

}  // namespace rf
