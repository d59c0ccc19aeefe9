// SPDX-License-Identifier: BSD-3-Clause
#include "kinematics/urdf_reader.hpp"

#include <console_bridge/console.h>
#include <fmt/format.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>

#include "kinematics/error.hpp"

namespace rf {
namespace {

constexpr std::size_t kMaxBytes = 16U << 20U;
constexpr int kMaxDepth = 64;  // of XML elements; the parser below recurses
constexpr std::size_t kMaxLinks = 2048;
constexpr double kMinAxis = 1e-6;

/// Keeps what urdfdom says instead of printing it. urdfdom's handler is global to the process.
class Listener : public console_bridge::OutputHandler {
 public:
  Listener() : before_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~Listener() override { console_bridge::useOutputHandler(before_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR || text_.size() > 1000) return;
    if (!text_.empty()) text_ += "; ";
    text_ += text;
  }
  const std::string& text() const { return text_; }

 private:
  console_bridge::OutputHandler* before_;
  std::string text_;
};

/// How deep elements nest, without parsing: the parser recurses and would overflow the stack.
int nesting(const std::string& xml) {
  int depth = 0;
  int deepest = 0;
  for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    if (xml.compare(at, 4, "<!--") == 0) {
      at = xml.find("-->", at);
      if (at == std::string::npos) break;
      continue;
    }
    const char next = at + 1 < xml.size() ? xml[at + 1] : '\0';
    if (next == '?' || next == '!') continue;
    if (next == '/') {
      --depth;
      continue;
    }
    const std::size_t end = xml.find('>', at);
    if (end == std::string::npos || xml[end - 1] != '/') deepest = std::max(deepest, ++depth);
  }
  return deepest;
}

void checkText(const std::string& xml, const std::string& source) {
  if (xml.size() > kMaxBytes) {
    throw KinematicsError(
        source, fmt::format("has {} bytes, a URDF may have at most {}", xml.size(), kMaxBytes));
  }
  if (xml.find('\0') != std::string::npos) {
    throw KinematicsError(source, fmt::format("byte {} is zero: not a text", xml.find('\0')));
  }
  if (const int depth = nesting(xml); depth > kMaxDepth) {
    throw KinematicsError(
        source, fmt::format("elements nest {} deep, at most {} are allowed", depth, kMaxDepth));
  }
}

urdf::ModelInterfaceSharedPtr parse(const std::string& xml, const std::string& source) {
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  Listener listener;
  urdf::ModelInterfaceSharedPtr model;
  std::string thrown;
  try {
    model = urdf::parseURDF(xml);
  } catch (const std::exception& e) {
    thrown = e.what();
  }
  if (model && listener.text().empty()) return model;
  const std::string why = !listener.text().empty() ? listener.text()
                          : !thrown.empty()        ? thrown
                                                   : "the parser does not say why";
  throw KinematicsError(source, "not a usable URDF: " + why);
}

bool isFinite(const urdf::Pose& pose) {
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 0;
  pose.rotation.getQuaternion(x, y, z, w);
  const urdf::Vector3& p = pose.position;
  return std::isfinite(p.x + p.y + p.z) && std::isfinite(x + y + z + w);
}

bool turnsOrSlides(const urdf::Joint& joint) {
  return joint.type == urdf::Joint::REVOLUTE || joint.type == urdf::Joint::CONTINUOUS ||
         joint.type == urdf::Joint::PRISMATIC;
}

void checkJoint(const urdf::Joint& joint, const std::string& source) {
  if (!isFinite(joint.parent_to_joint_origin_transform)) {
    throw KinematicsError(source, fmt::format("joint '{}': origin is not finite", joint.name));
  }
  if (!turnsOrSlides(joint)) return;
  const urdf::Vector3& a = joint.axis;
  const double length = std::hypot(a.x, a.y, a.z);
  if (!(std::isfinite(length) && length > kMinAxis)) {
    throw KinematicsError(source, fmt::format("joint '{}': axis is {} {} {}, must not be zero",
                                              joint.name, a.x, a.y, a.z));
  }
}

/// Follows mimic joints to the joint that moves by itself.
void checkMimic(const urdf::ModelInterface& model, const urdf::Joint& joint,
                const std::string& source) {
  const urdf::Joint* at = &joint;
  for (std::size_t steps = 0; at->mimic; ++steps) {
    const auto fail = [&](const std::string& rule) {
      return KinematicsError(source, fmt::format("joint '{}': mimics '{}', {}", at->name,
                                                 at->mimic->joint_name, rule));
    };
    if (!std::isfinite(at->mimic->multiplier + at->mimic->offset)) {
      throw fail("multiplier and offset must be finite");
    }
    const auto next = model.joints_.find(at->mimic->joint_name);
    if (next == model.joints_.end()) throw fail("which does not exist");
    if (!turnsOrSlides(*next->second)) throw fail("which does not move");
    if (steps > model.joints_.size()) throw fail("which leads back to itself");
    at = next->second.get();
  }
}

void checkTree(const urdf::ModelInterface& model, const std::string& source) {
  std::map<std::string, std::string> joint_above;
  for (const auto& [name, joint] : model.joints_) {
    const auto [known, fresh] = joint_above.emplace(joint->child_link_name, name);
    if (!fresh) {
      throw KinematicsError(source,
                            fmt::format("link '{}': is the child of joint '{}' and of joint '{}', "
                                        "must have one parent",
                                        joint->child_link_name, known->second, name));
    }
  }
  for (const auto& [name, link] : model.links_) {
    std::string at = name;
    std::set<std::string> seen;
    for (auto up = joint_above.find(at); up != joint_above.end(); up = joint_above.find(at)) {
      if (!seen.insert(at).second) {
        throw KinematicsError(
            source, fmt::format("joint '{}': closes a loop, links must form a tree", up->second));
      }
      at = model.joints_.at(up->second)->parent_link_name;
    }
  }
}

/// checkTree; links that own each other in a circle are let go before the error leaves.
void refuseLoops(const urdf::ModelInterface& model, const std::string& source) {
  try {
    checkTree(model, source);
  } catch (const KinematicsError&) {
    for (const auto& [name, link] : model.links_) link->child_links.clear();
    throw;
  }
}

}  // namespace

urdf::ModelInterfaceSharedPtr readUrdf(const std::string& xml, const std::string& source) {
  checkText(xml, source);
  urdf::ModelInterfaceSharedPtr model = parse(xml, source);
  if (model->links_.size() > kMaxLinks) {
    throw KinematicsError(source, fmt::format("has {} links, at most {} are allowed",
                                              model->links_.size(), kMaxLinks));
  }
  refuseLoops(*model, source);
  for (const auto& [name, joint] : model->joints_) checkJoint(*joint, source);
  for (const auto& [name, joint] : model->joints_) checkMimic(*model, *joint, source);
  return model;
}

}  // namespace rf
