// SPDX-License-Identifier: BSD-3-Clause
#include "priors/robot_covariance.hpp"

namespace rf {
namespace {

Mat6 moved(const Mat6& ad, const Mat6& covariance) { return ad * covariance * ad.transpose(); }

Mat6 jointCovariance(const ChainPose& pose) {
  Mat6 out = Mat6::Zero();
  for (Eigen::Index i = 0; i < pose.J.cols(); ++i) {
    const Vec6 column = pose.J.col(i);
    out += pose.variance[i] * column * column.transpose();
  }
  return out;
}

}  // namespace

ChainPose chainPoseWithNoise(const RobotModel& robot, const std::string& a, const std::string& b,
                             const JointPositions& q, const RobotConfig& config) {
  const RobotJacobian jacobian = robot.jacobian(a, b, q);
  ChainPose out{robot.T_AB(a, b, q), jacobian.J, {}};
  out.variance.resize(static_cast<Eigen::Index>(jacobian.joints.size()));
  for (std::size_t i = 0; i < jacobian.joints.size(); ++i) {
    const bool slides = robot.jointKind(jacobian.joints[i]) == JointKind::kPrismatic;
    const double sigma = slides ? config.slide_sigma : config.encoder_sigma;
    out.variance[static_cast<Eigen::Index>(i)] = sigma * sigma;
  }
  return out;
}

Mat6 cameraMotionCovariance(const ChainPose& T_BC_a, const ChainPose& T_BC_b, const SE3& T_CaCb,
                            const Mat6& base_cov) {
  // (T_BCa exp(ea))^-1 d exp(e) T_BCb exp(eb)
  //   = T_CaCb exp(-Ad(T_CaCb^-1) ea + Ad(T_BCb^-1) e + eb) to first order.
  return moved(T_CaCb.inverse().adjoint(), jointCovariance(T_BC_a)) +
         moved(T_BC_b.T.inverse().adjoint(), base_cov) + jointCovariance(T_BC_b);
}

Mat6 heldMotionCovariance(const ChainPose& T_CG_a, const ChainPose& T_CG_b, const SE3& T_GO,
                          const Mat6& slip_cov) {
  // T_CGa exp(ea) T_GO (T_CGb exp(eb) T_GO exp(s))^-1
  //   = T_COa T_COb^-1 exp(Ad(T_CGb) (ea - eb) - Ad(T_COb) s) to first order.
  return moved(T_CG_b.T.adjoint(), jointCovariance(T_CG_a) + jointCovariance(T_CG_b)) +
         moved((T_CG_b.T * T_GO).adjoint(), slip_cov);
}

}  // namespace rf
