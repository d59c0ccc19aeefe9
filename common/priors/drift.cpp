// SPDX-License-Identifier: BSD-3-Clause
#include "priors/drift.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

namespace rf {
namespace {

constexpr double kCellsPerSecond = 30.0;
constexpr std::size_t kNormalisedCells = 450;  // 15 s, the length of the paper's sequences
constexpr double kConstantShare = 0.3;         // of the translational rate's root mean square
constexpr double kFilterSeconds = 0.6;         // two in a row: the twist stays alike for about 1 s
constexpr double kForgetSeconds = 4.0;         // of the angle that white rotation adds up to
constexpr int kBurnInCells = 300;
constexpr std::int64_t kMaxSpanUs = 86'400'000'000;  // one day

/// Normal numbers that do not depend on the standard library's distributions.
class NormalSource {
 public:
  explicit NormalSource(std::uint64_t seed) : bits_(seed) {}
  Vec3 vector() { return {next(), next(), next()}; }

 private:
  double uniform() { return (static_cast<double>(bits_() >> 11) + 0.5) * 0x1p-53; }
  double next() {
    const double radius = std::sqrt(-2.0 * std::log(uniform()));
    return radius * std::cos(2.0 * std::numbers::pi * uniform());
  }
  std::mt19937_64 bits_;
};

struct Rate {
  Vec3 linear;
  Vec3 angular;
};

/// Noise of unit variance (per axis) that stays alike for about a second: a cascade of two equal
/// first-order filters, started in its stationary state.
class SlowNoise {
 public:
  explicit SlowNoise(NormalSource& normal) : normal_(normal) {
    for (int i = 0; i < kBurnInCells; ++i) next();
  }
  Vec3 next() {
    const double keep = std::exp(-1.0 / (kCellsPerSecond * kFilterSeconds));
    const double gain = 1.0 - keep;
    first_ = keep * first_ + gain * normal_.vector();
    second_ = keep * second_ + gain * first_;
    // Variance of this cascade for unit input: gain^4 (1 + keep^2) / (1 - keep^2)^3.
    const double rest = 1.0 - keep * keep;
    return second_ / std::sqrt(std::pow(gain, 4) * (1.0 + keep * keep) / (rest * rest * rest));
  }

 private:
  NormalSource& normal_;
  Vec3 first_ = Vec3::Zero();
  Vec3 second_ = Vec3::Zero();
};

/// White noise of about unit variance (per axis) without its slow part: each step also takes back a
/// little of what has added up, so that the angle forgets within kForgetSeconds.
class NearlyWhiteNoise {
 public:
  explicit NearlyWhiteNoise(NormalSource& normal) : normal_(normal) {}
  Vec3 next() {
    Vec3 rate = normal_.vector() - sum_ / (kCellsPerSecond * kForgetSeconds);
    sum_ += rate;
    return rate;
  }

 private:
  NormalSource& normal_;
  Vec3 sum_ = Vec3::Zero();
};

/// The spec's seed and stream, spread so that neighbouring pairs share nothing.
std::uint64_t mixedSeed(const DriftSpec& spec) {
  return spec.seed * 0x9E3779B97F4A7C15ULL +
         0x632BE59BD9B4E019ULL * (static_cast<std::uint64_t>(spec.stream) + 1);
}

/// Rates of unit variance per axis, before they are scaled to the spec.
std::vector<Rate> unitRates(std::size_t cells, std::uint64_t seed) {
  NormalSource normal(seed);
  // A direction alone: how strong the constant part is must not depend on the seed. For the same
  // reason the slow part loses its own mean.
  const Vec3 constant = kConstantShare * std::sqrt(3.0) * normal.vector().normalized();
  const double slow_gain = std::sqrt(1.0 - kConstantShare * kConstantShare);
  SlowNoise slow(normal);
  NearlyWhiteNoise white(normal);
  std::vector<Rate> rates(cells);
  Vec3 mean = Vec3::Zero();
  for (std::size_t i = 0; i < cells; ++i) {
    rates[i] = {slow.next(), white.next()};
    if (i < kNormalisedCells) mean += rates[i].linear / kNormalisedCells;
  }
  for (Rate& rate : rates) rate.linear = constant + slow_gain * (rate.linear - mean);
  return rates;
}

std::vector<Rate> ratesOnGrid(std::size_t cells, const DriftSpec& spec) {
  std::vector<Rate> rates =
      unitRates(std::max<std::size_t>(cells, kNormalisedCells), mixedSeed(spec));
  double linear = 0;
  double angular = 0;
  for (std::size_t i = 0; i < kNormalisedCells; ++i) {
    linear += rates[i].linear.norm() / kNormalisedCells;
    angular += rates[i].angular.norm() / kNormalisedCells;
  }
  for (Rate& rate : rates) {
    rate.linear *= spec.translation_mps / linear;
    rate.angular *= spec.rotation_radps / angular;
  }
  return rates;
}

/// Integral of the piecewise constant rates from `begin` to `end`, in cells from the first pose.
Vec6 integrate(const std::vector<Rate>& rates, double begin, double end) {
  Vec6 twist = Vec6::Zero();
  const auto last = static_cast<std::size_t>(std::ceil(end));
  for (auto i = static_cast<std::size_t>(begin); i < last && i < rates.size(); ++i) {
    const double from = std::max(begin, static_cast<double>(i));
    const double to = std::min(end, static_cast<double>(i + 1));
    const double seconds = std::max(0.0, to - from) / kCellsPerSecond;
    twist.head<3>() += seconds * rates[i].linear;
    twist.tail<3>() += seconds * rates[i].angular;
  }
  return twist;
}

void checkRate(const char* name, double value) {
  if (std::isfinite(value) && value >= 0) return;
  throw std::invalid_argument(std::string("addDrift: ") + name + " = " + std::to_string(value) +
                              ": must be finite and >= 0");
}

void checkTrajectory(std::span<const DriftPose> trajectory) {
  for (std::size_t k = 0; k < trajectory.size(); ++k) {
    const std::string where = "addDrift: pose " + std::to_string(k);
    if (!trajectory[k].second.isFinite()) throw std::invalid_argument(where + " is not finite");
    if (k > 0 && trajectory[k].first <= trajectory[k - 1].first) {
      throw std::invalid_argument(where + ": time " + std::to_string(trajectory[k].first) +
                                  " us must be after " + std::to_string(trajectory[k - 1].first));
    }
  }
  if (!trajectory.empty() && trajectory.back().first - trajectory.front().first > kMaxSpanUs) {
    throw std::invalid_argument("addDrift: the trajectory spans more than one day");
  }
}

}  // namespace

std::vector<DriftPose> addDrift(std::span<const DriftPose> trajectory, const DriftSpec& spec) {
  checkRate("translation_mps", spec.translation_mps);
  checkRate("rotation_radps", spec.rotation_radps);
  checkTrajectory(trajectory);
  std::vector<DriftPose> out(trajectory.begin(), trajectory.end());
  if (out.size() < 2) return out;
  const auto cell = [&](std::size_t k) {
    return static_cast<double>(trajectory[k].first - trajectory[0].first) * 1e-6 * kCellsPerSecond;
  };
  const std::vector<Rate> rates =
      ratesOnGrid(static_cast<std::size_t>(std::ceil(cell(out.size() - 1))) + 1, spec);
  for (std::size_t k = 1; k < out.size(); ++k) {
    const SE3 step = trajectory[k - 1].second.inverse() * trajectory[k].second;
    const Vec6 twist = integrate(rates, cell(k - 1), cell(k));
    SE3 pose = out[k - 1].second * step * SE3::exp(twist);
    pose.q.normalize();
    out[k].second = pose;
  }
  return out;
}

}  // namespace rf
