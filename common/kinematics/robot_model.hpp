// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "geometry/se3.hpp"
#include "kinematics/error.hpp"
#include "values/robot_shape.hpp"

namespace rf {

/// Positions of movable joints by name, radians or metres.
using JointPositions = std::map<std::string, double>;

/// A collision shape of a URDF, posed in its link.
struct LinkShape {
  std::string link;
  RobotShapeKind kind = RobotShapeKind::kBox;
  Vec3 half = Vec3::Zero();  ///< metres, as PosedShape::half
  SE3 T_LS;                  ///< shape -> link
};

enum class JointKind {
  kRevolute,
  kContinuous,  ///< turns without end: positions are angles modulo a turn
  kPrismatic,   ///< slides: metres
};

/// How the pose between two links answers to joints.
struct RobotJacobian {
  std::vector<std::string> joints;  ///< as jointsBetween
  /// One column per joint: T_AB(q + dq) = T_AB(q) exp(J dq), translation first, in frame B.
  Eigen::Matrix<double, 6, Eigen::Dynamic> J;
};

/// The links and joints of a robot as its URDF describes them: a tree of fixed, revolute,
/// continuous and prismatic joints; mimic joints follow the joint that they name. Floating and
/// planar joints may be there, but no pose is given across them. Immutable, cheap to copy (shared),
/// thread-safe.
class RobotModel {
 public:
  /// From the text of a URDF; `source` is what errors call it (a file name). Throws
  /// KinematicsError: malformed XML, numbers that are not finite, missing links, no root or
  /// several, loops, a link with two parents, a zero axis, a mimic joint without a master, a shape
  /// of no size.
  static RobotModel fromUrdf(const std::string& xml, const std::string& source);

  const std::string& rootLink() const;
  bool hasLink(const std::string& link) const;
  /// In tree order: a parent before its children, children by the order of joint names.
  std::vector<std::string> links() const;
  /// Joints that move by themselves, in tree order; mimic joints are resolved inside.
  std::vector<std::string> movableJoints() const;
  /// Of one of them. Throws KinematicsError when there is no such joint.
  JointKind jointKind(const std::string& joint) const;
  /// Those of them that T_AB(a, b) depends on, sorted by name. Throws KinematicsError on an unknown
  /// link, and when a floating or planar joint lies between.
  std::vector<std::string> jointsBetween(const std::string& a, const std::string& b) const;

  /// Pose of link b in link a. `q` may hold more joints than needed. Throws KinematicsError on an
  /// unknown link, a joint that `q` lacks, a position that is not finite, a joint that has no
  /// position (floating, planar).
  SE3 T_AB(const std::string& a, const std::string& b, const JointPositions& q) const;
  /// Derivative of that pose; the same errors.
  RobotJacobian jacobian(const std::string& a, const std::string& b, const JointPositions& q) const;

  /// Collision shapes in the order of links(). Meshes are not read.
  const std::vector<LinkShape>& collisionShapes() const;
  /// How many collision shapes are meshes, so not in collisionShapes().
  std::size_t skippedShapes() const;

 private:
  struct Data;
  explicit RobotModel(std::shared_ptr<const Data> data) : data_(std::move(data)) {}
  std::shared_ptr<const Data> data_;
};

}  // namespace rf
