// SPDX-License-Identifier: BSD-3-Clause
#include "calibration/closed_form.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace rf::calibration {
namespace {

constexpr double kStraight = 0.03;        ///< rad in one motion
constexpr double kTravelled = 0.05;       ///< m in one motion
constexpr double kDirectionWeight = 0.2;  ///< of travel (per metre) beside turning (per radian)

SE3 motionOf(const Path& path, const MotionRow& row, double offset) {
  return path.at(row.from - offset).inverse() * path.at(row.to - offset);
}

/// The rotation R that minimises the weighted sum of |a - R x|^2 with sum a x' = M.
Mat3 kabsch(const Mat3& M) {
  const Eigen::JacobiSVD<Mat3> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 sign = Mat3::Identity();
  sign(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * sign * svd.matrixV().transpose();
}

}  // namespace

SE3 closedFormTransform(const Path& path_A, const std::vector<MotionRow>& rows, double offset) {
  Mat3 M = Mat3::Zero();
  for (const MotionRow& row : rows) {
    const SE3 d_A = motionOf(path_A, row, offset);
    const Vec3 w_A = d_A.log().tail<3>();
    M += w_A * row.d_X.log().tail<3>().transpose();
    if (w_A.norm() < kStraight && d_A.t.norm() > kTravelled) {
      M += kDirectionWeight * d_A.t * row.d_X.t.transpose();
    }
  }
  const Mat3 R = kabsch(M);
  Mat3 H = Mat3::Zero();
  Vec3 g = Vec3::Zero();
  for (const MotionRow& row : rows) {
    const SE3 d_A = motionOf(path_A, row, offset);
    const Mat3 B = d_A.R() - Mat3::Identity();
    H += B.transpose() * B;
    g += B.transpose() * (R * row.d_X.t - d_A.t);
  }
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(H);
  Vec3 t = Vec3::Zero();
  for (int k = 0; k < 3; ++k) {
    const double value = eigen.eigenvalues()[k];
    if (value < 1e-3 * eigen.eigenvalues()[2] || value < 1e-6) continue;
    t += eigen.eigenvectors().col(k) * (eigen.eigenvectors().col(k).dot(g) / value);
  }
  return {R, t};
}

SE3 meanTransform(const Path& path_A, const std::vector<PoseRow>& rows, double offset) {
  SE3 mean = path_A.at(rows.front().time - offset).inverse() * rows.front().T_CX;
  for (int pass = 0; pass < 5; ++pass) {
    Vec6 sum = Vec6::Zero();
    for (const PoseRow& row : rows) {
      sum += (mean.inverse() * path_A.at(row.time - offset).inverse() * row.T_CX).log();
    }
    mean = mean * SE3::exp(sum / static_cast<double>(rows.size()));
  }
  return mean;
}

}  // namespace rf::calibration
