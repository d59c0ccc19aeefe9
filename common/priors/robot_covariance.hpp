// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "geometry/se3.hpp"
#include "kinematics/robot_model.hpp"
#include "priors/robot_config.hpp"

namespace rf {

/// A pose between two links with its derivative by the joints on the way.
struct ChainPose {
  SE3 T;                                       ///< T_AB
  Eigen::Matrix<double, 6, Eigen::Dynamic> J;  ///< T_AB exp(J dq)
  Eigen::VectorXd variance;                    ///< of each joint's position, rad^2 or m^2
};

ChainPose chainPoseWithNoise(const RobotModel& robot, const std::string& a, const std::string& b,
                             const JointPositions& q, const RobotConfig& config);

/// Covariance of the camera's motion T_CaCb = T_BCa^-1 T_BaBb T_BCb, right perturbation in C_b:
/// `base_cov` of T_BaBb (right, in B_b) through Ad(T_BCb^-1); joint errors at a and b, taken as
/// independent, through Ad(T_CaCb^-1) J_a and J_b.
Mat6 cameraMotionCovariance(const ChainPose& T_BC_a, const ChainPose& T_BC_b, const SE3& T_CaCb,
                            const Mat6& base_cov);

/// Covariance of the held object's motion in the camera T_COa T_COb^-1, right perturbation in C_b:
/// joint errors through Ad(T_CGb) J, slip in the gripper (right, in O_b) through Ad(T_COb).
Mat6 heldMotionCovariance(const ChainPose& T_CG_a, const ChainPose& T_CG_b, const SE3& T_GO,
                          const Mat6& slip_cov);

}  // namespace rf
