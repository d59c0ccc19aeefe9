// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/model_error.hpp"

#include <algorithm>
#include <cmath>

#include "evaluation/point_index.hpp"

namespace rf {
namespace {

constexpr float kFarthest = 0.5F;
constexpr float kLargestAside = 0.02F;
constexpr double kInlier = 0.10;
constexpr float kNormalTolerance = 0.1F;

std::vector<Eigen::Vector3f> positions(const std::vector<SurfelPoint>& points, const SE3& T) {
  std::vector<Eigen::Vector3f> result;
  result.reserve(points.size());
  for (const SurfelPoint& p : points) result.push_back((T * Vec3(p.x, p.y, p.z)).cast<float>());
  return result;
}

float distanceToSurface(const Eigen::Vector3f& point, const SurfelPoint& sample, float distance) {
  const Eigen::Vector3f normal(sample.nx, sample.ny, sample.nz);
  if (std::abs(normal.norm() - 1.0F) > kNormalTolerance) return distance;
  const Eigen::Vector3f offset = point - Eigen::Vector3f(sample.x, sample.y, sample.z);
  const float height = std::abs(offset.dot(normal.normalized()));
  const float aside = std::sqrt(std::max(0.0F, offset.squaredNorm() - height * height));
  return aside <= kLargestAside ? height : distance;
}

std::vector<float> accuracyDistances(const std::vector<Eigen::Vector3f>& model,
                                     const std::vector<SurfelPoint>& truth,
                                     const PointIndex& truth_index) {
  std::vector<float> distances;
  distances.reserve(model.size());
  for (const Eigen::Vector3f& point : model) {
    const auto neighbour = truth_index.nearest(point, kFarthest);
    distances.push_back(neighbour
                            ? distanceToSurface(point, truth[neighbour->index], neighbour->distance)
                            : kFarthest);
  }
  return distances;
}

double shareWithin(const std::vector<float>& distances, double limit) {
  if (distances.empty()) return 0;
  const auto within = std::count_if(distances.begin(), distances.end(),
                                    [&](float d) { return static_cast<double>(d) <= limit; });
  return static_cast<double>(within) / static_cast<double>(distances.size());
}

double rmseWithin(const std::vector<float>& distances, double limit) {
  double squares = 0;
  std::size_t count = 0;
  for (const double d : distances) {
    if (d > limit) continue;
    squares += d * d;
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(count));
}

double completeness(const std::vector<SurfelPoint>& truth, const PointIndex& model, double limit) {
  if (truth.empty()) return 0;
  std::size_t covered = 0;
  for (const SurfelPoint& p : truth) {
    covered += model.nearest({p.x, p.y, p.z}, static_cast<float>(limit)).has_value() ? 1 : 0;
  }
  return static_cast<double>(covered) / static_cast<double>(truth.size());
}

}  // namespace

ModelScore scoreModel(const std::vector<SurfelPoint>& model, const std::vector<SurfelPoint>& truth,
                      const SE3& T_truth_model, double limit) {
  ModelScore score;
  score.model_points = model.size();
  score.truth_points = truth.size();
  if (model.empty() || truth.empty()) return score;
  const std::vector<Eigen::Vector3f> moved = positions(model, T_truth_model);
  std::vector<float> distances =
      accuracyDistances(moved, truth, PointIndex(positions(truth, SE3())));
  std::sort(distances.begin(), distances.end());
  score.accuracy_median = 0.5 * (static_cast<double>(distances[(distances.size() - 1) / 2]) +
                                 static_cast<double>(distances[distances.size() / 2]));
  score.accuracy_rmse = rmseWithin(distances, kInlier);
  score.accuracy_share = shareWithin(distances, limit);
  score.completeness = completeness(truth, PointIndex(moved), limit);
  return score;
}

}  // namespace rf
