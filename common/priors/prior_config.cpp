// SPDX-License-Identifier: BSD-3-Clause
#include "priors/prior_config.hpp"

#include <cmath>
#include <stdexcept>

namespace rf {
namespace {
constexpr double kConfigQuaternionTolerance = 1e-3;
}

SE3 toTransform(const TransformConfig& c, const std::string& field) {
  const Eigen::Quaterniond q(c.qw, c.qx, c.qy, c.qz);
  const Vec3 t(c.x, c.y, c.z);
  if (!t.allFinite()) throw std::invalid_argument(field + ": translation must be finite");
  if (!(std::abs(q.norm() - 1.0) <= kConfigQuaternionTolerance)) {
    throw std::invalid_argument(field + ": quaternion length = " + std::to_string(q.norm()) +
                                ": must be 1 within 0.001");
  }
  return {q.normalized(), t};
}

Mat6 incrementCovariance(const DriftModel& model, const SE3& d, double seconds) {
  const Vec6 xi = d.log();
  const double sigma_t = std::hypot(model.sigma_v * seconds, model.sigma_v_per_m * d.t.norm());
  const double sigma_r =
      std::hypot(model.sigma_w * seconds, model.sigma_w_per_rad * xi.tail<3>().norm());
  Vec6 variance;
  variance << Vec3::Constant(sigma_t * sigma_t), Vec3::Constant(sigma_r * sigma_r);
  return variance.asDiagonal();
}

}  // namespace rf
