// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/robot_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kdl/tree.hpp>
#include <kdl_parser/kdl_parser.hpp>
#include <set>
#include <utility>

#include "kinematics/chain.hpp"
#include "kinematics/urdf_reader.hpp"

namespace rf {

struct RobotModel::Data {
  std::string source;
  std::string root;
  KDL::Tree tree;
  JointLaws laws;
  std::set<std::string> loose;  ///< floating and planar joints: fixed in `tree`, never crossed
  std::map<std::string, std::pair<std::string, std::string>> above;  ///< link -> parent link, joint
  std::vector<std::string> links;
  std::vector<std::string> movable;
  std::map<std::string, JointKind> kinds;  ///< of `movable`
  std::vector<LinkShape> shapes;
  std::size_t skipped = 0;

  void checkLink(const std::string& link) const;
  std::vector<std::string> way(const std::string& a, const std::string& b) const;
  KDL::Chain chain(const std::string& a, const std::string& b) const;
};

namespace {

SE3 toSE3(const urdf::Pose& pose) {
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 1;
  pose.rotation.getQuaternion(x, y, z, w);
  return {Eigen::Quaterniond(w, x, y, z).normalized(),
          Vec3(pose.position.x, pose.position.y, pose.position.z)};
}

bool isMovable(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
         joint.type == urdf::Joint::PRISMATIC;
}

bool isLoose(const urdf::Joint& joint) {
  return !isMovable(joint) && joint.type != urdf::Joint::FIXED;
}

JointKind kindOf(const urdf::Joint& joint) {
  if (joint.type == urdf::Joint::PRISMATIC) return JointKind::kPrismatic;
  return joint.type == urdf::Joint::CONTINUOUS ? JointKind::kContinuous : JointKind::kRevolute;
}

/// Mimic joints followed to the joint that moves by itself; readUrdf saw that there is one.
JointLaw lawOf(const urdf::ModelInterface& model, const urdf::Joint& joint) {
  JointLaw law{joint.name, 1, 0};
  const urdf::Joint* at = &joint;
  while (at->mimic) {
    law.offset += law.multiplier * at->mimic->offset;
    law.multiplier *= at->mimic->multiplier;
    law.master = at->mimic->joint_name;
    at = model.joints_.at(law.master).get();
  }
  return law;
}

/// The shape's kind and half sizes; false for a mesh.
bool solidOf(const urdf::Geometry& geometry, LinkShape& out) {
  if (const auto* box = dynamic_cast<const urdf::Box*>(&geometry)) {
    out.kind = RobotShapeKind::kBox;
    out.half = Vec3(box->dim.x, box->dim.y, box->dim.z) / 2;
    return true;
  }
  if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(&geometry)) {
    out.kind = RobotShapeKind::kCylinder;
    out.half = Vec3(cylinder->radius, cylinder->radius, cylinder->length / 2);
    return true;
  }
  if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(&geometry)) {
    out.kind = RobotShapeKind::kSphere;
    out.half = Vec3::Constant(sphere->radius);
    return true;
  }
  return false;
}

void checkShape(const LinkShape& shape, const std::string& source) {
  if (shape.half.allFinite() && shape.half.minCoeff() > 0 && shape.T_LS.isFinite()) return;
  throw KinematicsError(
      source, fmt::format("link '{}': a collision shape has half sizes {} {} {} m at {} {} {}, "
                          "must be finite and have a size",
                          shape.link, shape.half.x(), shape.half.y(), shape.half.z(),
                          shape.T_LS.t.x(), shape.T_LS.t.y(), shape.T_LS.t.z()));
}

/// kdl_parser speaks of what KDL has no use for (inertia of the root, loose joints): take it out.
void stripForKdl(const urdf::ModelInterface& model) {
  for (const auto& [name, link] : model.links_) link->inertial.reset();
  for (const auto& [name, joint] : model.joints_) {
    if (isLoose(*joint)) joint->type = urdf::Joint::FIXED;
  }
}

/// Joints below a link by name, so that the order does not depend on the file.
std::vector<urdf::JointSharedPtr> jointsBelow(const urdf::Link& link) {
  std::vector<urdf::JointSharedPtr> joints = link.child_joints;
  std::sort(joints.begin(), joints.end(),
            [](const auto& a, const auto& b) { return a->name < b->name; });
  return joints;
}

}  // namespace

void RobotModel::Data::checkLink(const std::string& link) const {
  if (link != root && !above.count(link))
    throw KinematicsError(source, fmt::format("link '{}': there is no such link", link));
}

std::vector<std::string> RobotModel::Data::way(const std::string& a, const std::string& b) const {
  const auto up = [this](std::string link) {
    std::vector<std::string> joints;
    for (auto at = above.find(link); at != above.end(); at = above.find(link)) {
      joints.push_back(at->second.second);
      link = at->second.first;
    }
    std::reverse(joints.begin(), joints.end());
    return joints;
  };
  checkLink(a);
  checkLink(b);
  const std::vector<std::string> to_a = up(a);
  const std::vector<std::string> to_b = up(b);
  const auto fork = std::mismatch(to_a.begin(), to_a.end(), to_b.begin(), to_b.end());
  std::vector<std::string> joints(fork.first, to_a.end());
  joints.insert(joints.end(), fork.second, to_b.end());
  return joints;
}

KDL::Chain RobotModel::Data::chain(const std::string& a, const std::string& b) const {
  for (const std::string& joint : way(a, b)) {
    if (loose.count(joint)) {
      throw KinematicsError(source, fmt::format("joint '{}' between '{}' and '{}': is floating or "
                                                "planar, has no position to compute with",
                                                joint, a, b));
    }
  }
  KDL::Chain out;
  if (!tree.getChain(a, b, out)) {
    throw KinematicsError(source, fmt::format("no chain between '{}' and '{}'", a, b));
  }
  return out;
}

RobotModel RobotModel::fromUrdf(const std::string& xml, const std::string& source) {
  const urdf::ModelInterfaceSharedPtr model = readUrdf(xml, source);
  auto data = std::make_shared<Data>();
  data->source = source;
  data->root = model->getRoot()->name;
  for (const auto& [name, joint] : model->joints_) {
    if (isMovable(*joint)) data->laws[name] = lawOf(*model, *joint);
    if (isLoose(*joint)) data->loose.insert(name);
  }
  std::vector<urdf::LinkConstSharedPtr> stack{model->getRoot()};
  while (!stack.empty()) {
    const urdf::LinkConstSharedPtr link = stack.back();
    stack.pop_back();
    data->links.push_back(link->name);
    for (const auto& collision : link->collision_array) {
      LinkShape shape;
      if (!collision || !collision->geometry || !solidOf(*collision->geometry, shape)) {
        ++data->skipped;
        continue;
      }
      shape.link = link->name;
      shape.T_LS = toSE3(collision->origin);
      checkShape(shape, source);
      data->shapes.push_back(shape);
    }
    if (const auto& joint = link->parent_joint) {
      data->above[link->name] = {joint->parent_link_name, joint->name};
      if (isMovable(*joint) && !joint->mimic) {
        data->movable.push_back(joint->name);
        data->kinds[joint->name] = kindOf(*joint);
      }
    }
    const auto below = jointsBelow(*link);
    for (auto joint = below.rbegin(); joint != below.rend(); ++joint)
      stack.push_back(model->getLink((*joint)->child_link_name));
  }
  stripForKdl(*model);
  if (!kdl_parser::treeFromUrdfModel(*model, data->tree))
    throw KinematicsError(source, "kdl_parser makes no tree of it");
  return RobotModel(std::move(data));
}

const std::string& RobotModel::rootLink() const { return data_->root; }
bool RobotModel::hasLink(const std::string& link) const {
  return link == data_->root || data_->above.count(link) > 0;
}
std::vector<std::string> RobotModel::links() const { return data_->links; }
std::vector<std::string> RobotModel::movableJoints() const { return data_->movable; }

JointKind RobotModel::jointKind(const std::string& joint) const {
  const auto found = data_->kinds.find(joint);
  if (found == data_->kinds.end()) {
    throw KinematicsError(data_->source,
                          fmt::format("joint '{}': there is no such movable joint", joint));
  }
  return found->second;
}

std::vector<std::string> RobotModel::jointsBetween(const std::string& a,
                                                   const std::string& b) const {
  data_->chain(a, b);
  std::set<std::string> masters;
  for (const std::string& joint : data_->way(a, b)) {
    const auto law = data_->laws.find(joint);
    if (law != data_->laws.end()) masters.insert(law->second.master);
  }
  return {masters.begin(), masters.end()};
}

SE3 RobotModel::T_AB(const std::string& a, const std::string& b, const JointPositions& q) const {
  return chainPose(data_->chain(a, b), data_->laws, q, data_->source);
}

RobotJacobian RobotModel::jacobian(const std::string& a, const std::string& b,
                                   const JointPositions& q) const {
  return chainJacobian(data_->chain(a, b), data_->laws, q, data_->source);
}

const std::vector<LinkShape>& RobotModel::collisionShapes() const { return data_->shapes; }
std::size_t RobotModel::skippedShapes() const { return data_->skipped; }

}  // namespace rf
