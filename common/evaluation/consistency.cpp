// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/consistency.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Cholesky>

namespace rf {
namespace {

// 95 % quantiles of chi-squared with 3 and 6 degrees of freedom.
constexpr double kBound3 = 7.8147;
constexpr double kBound6 = 12.5916;

template <int kSize>
double normalised(const Eigen::Matrix<double, kSize, 1>& e,
                  const Eigen::Matrix<double, kSize, kSize>& P, std::int64_t utime) {
  // Translations and rotations differ by orders of magnitude: factor the correlation matrix.
  const Eigen::Matrix<double, kSize, 1> sigma = P.diagonal().cwiseMax(0.0).cwiseSqrt();
  if (!(sigma.minCoeff() > 0)) {
    throw std::invalid_argument(
        fmt::format("covariance at utime {}: must be positive definite", utime));
  }
  const Eigen::Matrix<double, kSize, 1> scale = sigma.cwiseInverse();
  const Eigen::Matrix<double, kSize, kSize> C = scale.asDiagonal() * P * scale.asDiagonal();
  const Eigen::LLT<Eigen::Matrix<double, kSize, kSize>> factor(C);
  if (factor.info() != Eigen::Success) {
    throw std::invalid_argument(
        fmt::format("covariance at utime {}: must be positive definite", utime));
  }
  const Eigen::Matrix<double, kSize, 1> whitened = factor.matrixL().solve(scale.cwiseProduct(e));
  return whitened.squaredNorm();
}

/// `squares`: e' P^-1 e of each sample.
Nees summary(std::vector<double> squares, int freedom, double bound) {
  Nees out;
  if (squares.empty()) return out;
  const auto above =
      std::count_if(squares.begin(), squares.end(), [&](double x) { return x > bound; });
  out.share_above_95 = static_cast<double>(above) / static_cast<double>(squares.size());
  for (double& x : squares) x /= freedom;
  const ErrorStatistics s = statistics(std::move(squares));
  out.mean = s.mean;
  out.median = s.median;
  return out;
}

}  // namespace

std::vector<ErrorSample> errorSamples(const std::vector<PosePair>& pairs,
                                      const PoseCovariances& covariances, const SE3& world,
                                      const SE3& offset) {
  std::vector<ErrorSample> samples;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    const auto at = std::lower_bound(
        covariances.begin(), covariances.end(), pairs[i].utime,
        [](const PoseCovariance& c, std::int64_t utime) { return c.utime < utime; });
    if (at == covariances.end() || at->utime != pairs[i].utime) continue;
    const SE3 truth = world.inverse() * pairs[i].truth * offset.inverse();
    samples.push_back({(pairs[i].estimate.inverse() * truth).log(), *at});
  }
  return samples;
}

Consistency scoreConsistency(const std::vector<ErrorSample>& samples) {
  Consistency out;
  out.samples = samples.size();
  std::vector<double> pose, translation, rotation;
  for (const ErrorSample& s : samples) {
    const Mat6& P = s.claim.covariance;
    pose.push_back(normalised<6>(s.error, P, s.claim.utime));
    translation.push_back(normalised<3>(s.error.head<3>(), P.topLeftCorner<3, 3>(), s.claim.utime));
    rotation.push_back(
        normalised<3>(s.error.tail<3>(), P.bottomRightCorner<3, 3>(), s.claim.utime));
    if (s.claim.health != Health::kTracked) continue;
    ++out.tracked;
    if (s.error.head<3>().norm() > kMisplaced) ++out.misplaced;
  }
  out.pose = summary(std::move(pose), 6, kBound6);
  out.translation = summary(std::move(translation), 3, kBound3);
  out.rotation = summary(std::move(rotation), 3, kBound3);
  return out;
}

}  // namespace rf
