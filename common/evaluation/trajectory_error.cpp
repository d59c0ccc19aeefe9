// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include <Eigen/SVD>

namespace rf {
namespace {

constexpr std::int64_t kEndSlackUs = 10000;  // time stamps jitter

double angleOf(const SE3& T) { return 2.0 * std::atan2(T.q.vec().norm(), std::abs(T.q.w())); }

/// Index of the pair whose time is nearest to `utime`.
std::size_t nearestPair(const std::vector<PosePair>& pairs, std::int64_t utime) {
  const auto after =
      std::lower_bound(pairs.begin(), pairs.end(), utime,
                       [](const PosePair& p, std::int64_t t) { return p.utime < t; });
  if (after == pairs.begin()) return 0;
  const auto before = std::prev(after);
  const bool take_after = after != pairs.end() && after->utime - utime < utime - before->utime;
  return static_cast<std::size_t>((take_after ? after : before) - pairs.begin());
}

std::size_t countPosed(const Trajectory& estimate, const std::vector<std::int64_t>& frames) {
  return static_cast<std::size_t>(
      std::count_if(estimate.begin(), estimate.end(), [&](const StampedPose& p) {
        return std::binary_search(frames.begin(), frames.end(), p.utime);
      }));
}

TrajectoryScore score(const std::vector<PosePair>& pairs, const SE3& first, const Trajectory& all,
                      const std::vector<std::int64_t>& frames) {
  TrajectoryScore s;
  s.ate_first = absoluteError(pairs, first);
  s.ate_aligned = absoluteError(pairs, alignPositions(pairs));
  s.rpe = relativeError(pairs);
  s.frames = frames.size();
  s.posed = countPosed(all, frames);
  s.matched = pairs.size();
  s.coverage =
      frames.empty() ? 0.0 : static_cast<double>(s.posed) / static_cast<double>(frames.size());
  return s;
}

}  // namespace

ErrorStatistics statistics(std::vector<double> errors) {
  ErrorStatistics s;
  s.count = errors.size();
  if (errors.empty()) return s;
  const double n = static_cast<double>(errors.size());
  double squares = 0;
  for (const double e : errors) {
    squares += e * e;
    s.mean += e / n;
  }
  s.rmse = std::sqrt(squares / n);
  std::sort(errors.begin(), errors.end());
  s.max = errors.back();
  s.median = 0.5 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]);
  return s;
}

std::vector<PosePair> matchPoses(const Trajectory& estimate, const Trajectory& truth,
                                 std::int64_t max_difference_us) {
  std::vector<std::tuple<std::int64_t, std::size_t, std::size_t>> candidates;
  std::size_t begin = 0;
  for (std::size_t e = 0; e < estimate.size(); ++e) {
    const std::int64_t t = estimate[e].utime;
    while (begin < truth.size() && truth[begin].utime < t - max_difference_us) ++begin;
    for (std::size_t g = begin; g < truth.size() && truth[g].utime <= t + max_difference_us; ++g) {
      candidates.emplace_back(std::abs(truth[g].utime - t), e, g);
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<bool> estimate_taken(estimate.size(), false);
  std::vector<bool> truth_taken(truth.size(), false);
  std::vector<PosePair> pairs;
  for (const auto& [difference, e, g] : candidates) {
    if (estimate_taken[e] || truth_taken[g]) continue;
    estimate_taken[e] = truth_taken[g] = true;
    pairs.push_back({estimate[e].utime, estimate[e].pose, truth[g].pose});
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const PosePair& a, const PosePair& b) { return a.utime < b.utime; });
  return pairs;
}

ErrorStatistics absoluteError(const std::vector<PosePair>& pairs, const SE3& S) {
  std::vector<double> errors;
  errors.reserve(pairs.size());
  for (const PosePair& p : pairs) errors.push_back((p.truth.t - S * p.estimate.t).norm());
  return statistics(std::move(errors));
}

SE3 alignFirstPose(const std::vector<PosePair>& pairs) {
  return pairs.empty() ? SE3() : pairs.front().truth * pairs.front().estimate.inverse();
}

SE3 alignPositions(const std::vector<PosePair>& pairs) {
  if (pairs.empty()) return {};
  const double n = static_cast<double>(pairs.size());
  Vec3 mean_estimate = Vec3::Zero();
  Vec3 mean_truth = Vec3::Zero();
  for (const PosePair& p : pairs) {
    mean_estimate += p.estimate.t / n;
    mean_truth += p.truth.t / n;
  }
  if (pairs.size() < 3) return {Eigen::Quaterniond::Identity(), mean_truth - mean_estimate};
  Mat3 covariance = Mat3::Zero();
  for (const PosePair& p : pairs) {
    covariance += (p.truth.t - mean_truth) * (p.estimate.t - mean_estimate).transpose();
  }
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 mirror = Mat3::Identity();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) mirror(2, 2) = -1;
  const Mat3 R = svd.matrixU() * mirror * svd.matrixV().transpose();
  return {R, mean_truth - R * mean_estimate};
}

RelativeError relativeError(const std::vector<PosePair>& pairs, double delta_s,
                            double tolerance_s) {
  const auto delta = static_cast<std::int64_t>(std::llround(delta_s * 1e6));
  const auto tolerance = static_cast<std::int64_t>(std::llround(tolerance_s * 1e6));
  std::vector<double> translations;
  std::vector<double> rotations;
  for (const PosePair& i : pairs) {
    if (i.utime + delta > pairs.back().utime + kEndSlackUs) break;
    const PosePair& j = pairs[nearestPair(pairs, i.utime + delta)];
    if (std::abs(j.utime - i.utime - delta) > tolerance || j.utime <= i.utime) continue;
    const SE3 error = (i.truth.inverse() * j.truth).inverse() * (i.estimate.inverse() * j.estimate);
    translations.push_back(error.t.norm());
    rotations.push_back(angleOf(error));
  }
  return {statistics(std::move(translations)), statistics(std::move(rotations))};
}

TrajectoryScore scoreCamera(const Trajectory& estimate, const Trajectory& truth,
                            const std::vector<std::int64_t>& frames) {
  const std::vector<PosePair> pairs = matchPoses(estimate, truth);
  return score(pairs, alignFirstPose(pairs), estimate, frames);
}

std::optional<SE3> objectOffset(const Trajectory& estimate, const Trajectory& truth,
                                const SE3& world) {
  const std::vector<PosePair> pairs = matchPoses(estimate, truth);
  if (pairs.empty()) return std::nullopt;
  return (world * pairs.front().estimate).inverse() * pairs.front().truth;
}

TrajectoryScore scoreObject(const Trajectory& estimate, const Trajectory& truth,
                            const std::vector<std::int64_t>& frames, const SE3& world) {
  std::vector<PosePair> pairs = matchPoses(estimate, truth);
  const SE3 X = objectOffset(estimate, truth, world).value_or(SE3());
  for (PosePair& p : pairs) p.estimate = world * p.estimate * X;
  return score(pairs, SE3(), estimate, frames);
}

std::vector<double> speeds(const Trajectory& trajectory, std::size_t half_window) {
  std::vector<double> result(trajectory.size(), 0.0);
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    const StampedPose& a = trajectory[i >= half_window ? i - half_window : 0];
    const StampedPose& b = trajectory[std::min(trajectory.size() - 1, i + half_window)];
    if (b.utime <= a.utime) continue;
    result[i] = (b.pose.t - a.pose.t).norm() / (1e-6 * static_cast<double>(b.utime - a.utime));
  }
  return result;
}

}  // namespace rf
