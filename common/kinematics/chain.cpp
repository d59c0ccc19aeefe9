// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>

namespace rf {
namespace {

double positionOf(const std::string& joint, const JointLaw& law, const JointPositions& q,
                  const std::string& source) {
  const auto found = q.find(law.master);
  const std::string name =
      law.master == joint ? fmt::format("joint '{}'", joint)
                          : fmt::format("joint '{}' (which joint '{}' mimics)", law.master, joint);
  if (found == q.end()) throw KinematicsError(source, name + ": no position is given");
  if (!std::isfinite(found->second)) {
    throw KinematicsError(source,
                          fmt::format("{}: position is {}, must be finite", name, found->second));
  }
  return law.multiplier * found->second + law.offset;
}

/// Laws of the chain's movable joints from base to tip.
std::vector<std::pair<std::string, JointLaw>> lawsOf(const KDL::Chain& chain,
                                                     const JointLaws& laws) {
  std::vector<std::pair<std::string, JointLaw>> out;
  for (const KDL::Segment& segment : chain.segments) {
    const KDL::Joint& joint = segment.getJoint();
    if (joint.getType() != KDL::Joint::None)
      out.emplace_back(joint.getName(), laws.at(joint.getName()));
  }
  return out;
}

KDL::JntArray positions(const std::vector<std::pair<std::string, JointLaw>>& laws,
                        const JointPositions& q, const std::string& source) {
  KDL::JntArray out(static_cast<unsigned>(laws.size()));
  for (unsigned i = 0; i < laws.size(); ++i)
    out(i) = positionOf(laws[i].first, laws[i].second, q, source);
  return out;
}

Mat3 rotation(const KDL::Rotation& in) {
  Mat3 out;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) out(r, c) = in(r, c);
  }
  return out;
}

KDL::Frame forward(const KDL::Chain& chain, const KDL::JntArray& q) {
  KDL::ChainFkSolverPos_recursive solver(chain);
  KDL::Frame tip = KDL::Frame::Identity();
  if (chain.getNrOfSegments() > 0) solver.JntToCart(q, tip);
  return tip;
}

}  // namespace

SE3 chainPose(const KDL::Chain& chain, const JointLaws& laws, const JointPositions& q,
              const std::string& source) {
  const KDL::Frame tip = forward(chain, positions(lawsOf(chain, laws), q, source));
  return {rotation(tip.M), Vec3(tip.p.x(), tip.p.y(), tip.p.z())};
}

RobotJacobian chainJacobian(const KDL::Chain& chain, const JointLaws& laws, const JointPositions& q,
                            const std::string& source) {
  const auto on_the_way = lawsOf(chain, laws);
  RobotJacobian out;
  for (const auto& [joint, law] : on_the_way) out.joints.push_back(law.master);
  std::sort(out.joints.begin(), out.joints.end());
  out.joints.erase(std::unique(out.joints.begin(), out.joints.end()), out.joints.end());
  out.J.setZero(6, static_cast<Eigen::Index>(out.joints.size()));
  if (on_the_way.empty()) return out;

  const KDL::JntArray angles = positions(on_the_way, q, source);
  KDL::Jacobian base(static_cast<unsigned>(on_the_way.size()));
  KDL::ChainJntToJacSolver(chain).JntToJac(angles, base);
  // KDL: velocity of the tip's origin and angular velocity, both in the base's axes; ours: the
  // twist in the tip's axes, which moves the tip by T exp(xi).
  const Mat3 to_tip = rotation(forward(chain, angles).M).transpose();
  for (std::size_t i = 0; i < on_the_way.size(); ++i) {
    const JointLaw& law = on_the_way[i].second;
    const auto column = std::lower_bound(out.joints.begin(), out.joints.end(), law.master);
    const auto from = static_cast<Eigen::Index>(i);
    const Eigen::Index to = column - out.joints.begin();
    const Vec3 v = base.data.block<3, 1>(0, from);
    const Vec3 w = base.data.block<3, 1>(3, from);
    out.J.block<3, 1>(0, to) += law.multiplier * (to_tip * v);
    out.J.block<3, 1>(3, to) += law.multiplier * (to_tip * w);
  }
  return out;
}

}  // namespace rf
