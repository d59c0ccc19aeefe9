// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/time_offset.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rf::calibration {
namespace {

constexpr double kLagStep = 0.02;            ///< s
constexpr double kHalfWindow = 0.15;         ///< s; smooths the noise of seen poses
constexpr double kSmallestVariation = 0.02;  ///< rad/s or m/s: less is taken as noise

/// Speeds of turning and moving on a grid.
struct Speeds {
  std::vector<double> turning;
  std::vector<double> moving;
};

Speeds speedsOf(const Path& path, double from, std::size_t count) {
  Speeds speeds;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = from + static_cast<double>(i) * kLagStep;
    const SE3 d = path.at(t - kHalfWindow).inverse() * path.at(t + kHalfWindow);
    speeds.turning.push_back(d.log().tail<3>().norm() / (2 * kHalfWindow));
    speeds.moving.push_back(d.t.norm() / (2 * kHalfWindow));
  }
  return speeds;
}

/// Correlation of a[i + lag] with b[i] over the middle of b.
double correlation(const std::vector<double>& a, const std::vector<double>& b, int lag,
                   int margin) {
  double n = 0, sa = 0, sb = 0, saa = 0, sbb = 0, sab = 0;
  for (int i = margin; i + margin < std::ssize(b); ++i) {
    const double x = a[static_cast<std::size_t>(i + lag)];
    const double y = b[static_cast<std::size_t>(i)];
    n += 1;
    sa += x;
    sb += y;
    saa += x * x;
    sbb += y * y;
    sab += x * y;
  }
  if (n < 2) return 0;
  const double va = saa / n - sa * sa / (n * n);
  const double vb = sbb / n - sb * sb / (n * n);
  if (std::min(va, vb) < kSmallestVariation * kSmallestVariation) return 0;
  return (sab / n - sa * sb / (n * n)) / std::sqrt(va * vb);
}

OffsetGuess best(const std::vector<double>& a, const std::vector<double>& b, int margin) {
  OffsetGuess guess;
  for (int lag = -margin; lag <= margin; ++lag) {
    const double c = correlation(a, b, lag, margin);
    // a at t + lag * step is like b at t: what A stamps late must be moved back.
    if (c > guess.correlation) guess = {-lag * kLagStep, c};
  }
  return guess;
}

}  // namespace

OffsetGuess guessOffset(const Path& A, const Path& X, double largest) {
  const double from = std::max(A.begin(), X.begin());
  const double to = std::min(A.end(), X.end());
  if (to - from < 4 * kLagStep) return {};
  const auto count = static_cast<std::size_t>((to - from) / kLagStep);
  const Speeds a = speedsOf(A, from, count);
  const Speeds x = speedsOf(X, from, count);
  const int margin = static_cast<int>(std::ceil(largest / kLagStep));
  const OffsetGuess turning = best(a.turning, x.turning, margin);
  const OffsetGuess moving = best(a.moving, x.moving, margin);
  return turning.correlation >= moving.correlation ? turning : moving;
}

}  // namespace rf::calibration
