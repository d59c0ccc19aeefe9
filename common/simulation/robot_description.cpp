// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/robot_description.hpp"

#include <numbers>

#include <fmt/format.h>

namespace rf::sim {
namespace {

constexpr double kRight = std::numbers::pi / 2;

/// How a solid lies in its link: its axis z stays, or turns onto the link's x or y.
enum class Lie : std::uint8_t { kZ, kX, kY };

Vec3 rpyOf(Lie lie) {
  if (lie == Lie::kX) return {0, kRight, 0};
  if (lie == Lie::kY) return {kRight, 0, 0};
  return Vec3::Zero();
}

SE3 poseOf(const Vec3& xyz, const Vec3& rpy) {
  const Eigen::Quaterniond q = Eigen::AngleAxisd(rpy.z(), Vec3::UnitZ()) *
                               Eigen::AngleAxisd(rpy.y(), Vec3::UnitY()) *
                               Eigen::AngleAxisd(rpy.x(), Vec3::UnitX());
  return {q, xyz};
}

struct Solid {
  const char* link;
  ShapeKind kind;
  Vec3 centre;
  Vec3 half;
  Lie lie;
};

struct Joint {
  const char* name;
  const char* type;
  const char* parent;
  const char* child;
  Vec3 xyz;
  Vec3 rpy;
  Vec3 axis;
  double low, high;
  const char* mimic;
};

Vec3 round(double radius, double half_length) { return {radius, radius, half_length}; }

const std::vector<Joint>& joints() {
  static const Vec3 kX = Vec3::UnitX(), kY = Vec3::UnitY(), kZ = Vec3::UnitZ(), kNo = Vec3::Zero();
  static const std::vector<Joint> kJoints = {
      {"mast", "fixed", "base_link", "mast_link", {-0.14, 0, 0.32}, kNo, kX, 0, 0, ""},
      {"head_pan", "revolute", "mast_link", "pan_link", {0, 0, 0.71}, kNo, kZ, -1.6, 1.6, ""},
      {"head_tilt", "revolute", "pan_link", "tilt_link", {0, 0, 0.07}, kNo, kY, -0.6, 1.0, ""},
      {"camera", "fixed", "tilt_link", "camera_link", {0.035, 0, 0.02}, kNo, kX, 0, 0, ""},
      {"optical", "fixed", "camera_link", kCameraLink, kNo, {-kRight, 0, -kRight}, kX, 0, 0, ""},
      {"arm_1", "revolute", "base_link", "shoulder_link", {0.16, -0.12, 0.42}, kNo, kZ, -3, 3, ""},
      {"arm_2",
       "revolute",
       "shoulder_link",
       "upper_arm_link",
       {0, 0, 0.13},
       kNo,
       kY,
       -1.2,
       2.6,
       ""},
      {"arm_3", "revolute", "upper_arm_link", "forearm_link", {0, 0, 0.38}, kNo, kY, -2.7, 2.7, ""},
      {"arm_4", "revolute", "forearm_link", "wrist_1_link", {0, 0, 0.22}, kNo, kZ, -6.2, 6.2, ""},
      {"arm_5", "revolute", "wrist_1_link", "wrist_2_link", {0, 0, 0.12}, kNo, kY, -2.2, 2.2, ""},
      {"arm_6", "revolute", "wrist_2_link", "flange_link", {0, 0, 0.08}, kNo, kZ, -6.2, 6.2, ""},
      {"gripper", "fixed", "flange_link", kGripperLink, {0, 0, 0.03}, kNo, kX, 0, 0, ""},
      {"finger", "prismatic", kGripperLink, "finger_1_link", {0, 0, 0.085}, kNo, kY, 0, 0.085, ""},
      {"finger_2",
       "prismatic",
       kGripperLink,
       "finger_2_link",
       {0, 0, 0.085},
       kNo,
       -kY,
       0,
       0.085,
       "finger"}};
  return kJoints;
}

const std::vector<Solid>& collisionSolids() {
  constexpr ShapeKind kBox = ShapeKind::kBox;
  constexpr ShapeKind kRound = ShapeKind::kCylinder;
  static const std::vector<Solid> kSolids = {
      {"base_link", kBox, {0, 0, 0.165}, {0.32, 0.28, 0.165}, Lie::kZ},
      {"base_link", kRound, {0.16, -0.12, 0.37}, round(0.085, 0.055), Lie::kZ},
      {"base_link", kRound, {0.26, 0.05, 0.355}, round(0.05, 0.04), Lie::kZ},
      {"mast_link", kBox, {0, 0, 0.345}, {0.045, 0.06, 0.365}, Lie::kZ},
      {"pan_link", kRound, {0, 0, 0.03}, round(0.055, 0.035), Lie::kZ},
      {"tilt_link", kBox, {0.025, 0, 0.02}, {0.035, 0.10, 0.03}, Lie::kZ},
      {"shoulder_link", kRound, {0, 0, 0.06}, round(0.072, 0.07), Lie::kZ},
      {"upper_arm_link", kRound, {0, 0, 0}, round(0.068, 0.085), Lie::kY},
      {"upper_arm_link", kRound, {0, 0, 0.19}, round(0.058, 0.19), Lie::kZ},
      {"forearm_link", kRound, {0, 0, 0}, round(0.058, 0.072), Lie::kY},
      {"forearm_link", kRound, {0, 0, 0.11}, round(0.05, 0.115), Lie::kZ},
      {"wrist_1_link", kRound, {0, 0, 0.05}, round(0.043, 0.06), Lie::kZ},
      {"wrist_2_link", ShapeKind::kEllipsoid, {0, 0, 0}, Vec3::Constant(0.056), Lie::kZ},
      {"wrist_2_link", kRound, {0, 0, 0.04}, round(0.04, 0.04), Lie::kZ},
      {"flange_link", kRound, {0, 0, 0.015}, round(0.04, 0.018), Lie::kZ},
      {"gripper_link", kBox, {0, 0, 0.045}, {0.045, 0.105, 0.047}, Lie::kZ},
      {"finger_1_link", kBox, {0, 0.009, 0.058}, {0.02, 0.01, 0.064}, Lie::kZ},
      {"finger_2_link", kBox, {0, -0.009, 0.058}, {0.02, 0.01, 0.064}, Lie::kZ}};
  return kSolids;
}

struct Seen {
  Solid solid;
  RobotLook look;
};

void addFinger(std::vector<Seen>& out, const char* link, double side) {
  constexpr ShapeKind kBox = ShapeKind::kBox;
  out.push_back(
      {{link, kBox, {0, side * 0.011, 0.05}, {0.016, 0.006, 0.06}, Lie::kZ}, RobotLook::kMetal});
  out.push_back(
      {{link, kBox, {0, side * 0.008, 0.08}, {0.018, 0.008, 0.04}, Lie::kZ}, RobotLook::kRubber});
  out.push_back(
      {{link, kBox, {0, side * 0.013, 0.004}, {0.02, 0.012, 0.012}, Lie::kZ}, RobotLook::kDark});
}

std::vector<Seen> seenSolids() {
  constexpr ShapeKind kBox = ShapeKind::kBox;
  constexpr ShapeKind kRound = ShapeKind::kCylinder;
  using enum RobotLook;
  std::vector<Seen> out = {
      {{"base_link", kBox, {0, 0, 0.17}, {0.30, 0.225, 0.10}, Lie::kZ}, kShell},
      {{"base_link", kBox, {0, 0, 0.295}, {0.31, 0.235, 0.025}, Lie::kZ}, kDark},
      {{"base_link", kRound, {0.16, -0.12, 0.37}, round(0.08, 0.05), Lie::kZ}, kAccent},
      {{"base_link", kRound, {0.26, 0.05, 0.35}, round(0.045, 0.03), Lie::kZ}, kDark},
      {{"base_link", kRound, {0.26, 0.05, 0.385}, round(0.04, 0.006), Lie::kZ}, kAccent},
      {{"mast_link", kBox, {0, 0, 0.35}, {0.035, 0.05, 0.35}, Lie::kZ}, kMetal},
      {{"pan_link", kRound, {0, 0, 0.03}, round(0.05, 0.028), Lie::kZ}, kDark},
      {{"tilt_link", kBox, {0.03, 0, 0.02}, {0.02, 0.09, 0.018}, Lie::kZ}, kDark},
      {{"shoulder_link", kRound, {0, 0, 0.055}, round(0.068, 0.055), Lie::kZ}, kShell},
      {{"shoulder_link", kRound, {0, 0, 0.115}, round(0.06, 0.006), Lie::kZ}, kAccent},
      {{"upper_arm_link", kRound, {0, 0, 0}, round(0.062, 0.078), Lie::kY}, kDark},
      {{"upper_arm_link", kRound, {0, 0, 0.19}, round(0.05, 0.17), Lie::kZ}, kShell},
      {{"upper_arm_link", kRound, {0, 0, 0.30}, round(0.054, 0.008), Lie::kZ}, kAccent},
      {{"forearm_link", kRound, {0, 0, 0}, round(0.054, 0.067), Lie::kY}, kDark},
      {{"forearm_link", kRound, {0, 0, 0.11}, round(0.043, 0.10), Lie::kZ}, kShell},
      {{"forearm_link", kRound, {0, 0, 0.19}, round(0.047, 0.007), Lie::kZ}, kAccent},
      {{"forearm_link", kRound, {0.05, 0, 0.10}, round(0.008, 0.09), Lie::kZ}, kRubber},
      {{"wrist_1_link", kRound, {0, 0, 0.05}, round(0.038, 0.05), Lie::kZ}, kShell},
      {{"wrist_2_link", kRound, {0, 0, 0}, round(0.042, 0.05), Lie::kY}, kDark},
      {{"wrist_2_link", kRound, {0, 0, 0.04}, round(0.036, 0.036), Lie::kZ}, kShell},
      {{"flange_link", kRound, {0, 0, 0.015}, round(0.037, 0.015), Lie::kZ}, kMetal},
      {{"gripper_link", kBox, {0, 0, 0.03}, {0.04, 0.07, 0.03}, Lie::kZ}, kAccent},
      {{"gripper_link", kBox, {0, 0, 0.068}, {0.03, 0.10, 0.01}, Lie::kZ}, kMetal},
      {{"gripper_link", kBox, {0, 0, 0.082}, {0.02, 0.07, 0.008}, Lie::kZ}, kDark}};
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      out.push_back({{"base_link", kRound, {x * 0.21, y * 0.25, 0.08}, round(0.08, 0.025), Lie::kY},
                     kRubber});
    }
  }
  addFinger(out, "finger_1_link", 1);
  addFinger(out, "finger_2_link", -1);
  return out;
}

std::string triple(const Vec3& v) {
  return fmt::format("{:.9g} {:.9g} {:.9g}", v.x(), v.y(), v.z());
}

std::string geometryOf(const Solid& s) {
  switch (s.kind) {
    case ShapeKind::kBox:
      return fmt::format("<box size=\"{}\"/>", triple(2 * s.half));
    case ShapeKind::kCylinder:
      return fmt::format("<cylinder radius=\"{:.9g}\" length=\"{:.9g}\"/>", s.half.x(),
                         2 * s.half.z());
    case ShapeKind::kEllipsoid:
      break;
  }
  return fmt::format("<sphere radius=\"{:.9g}\"/>", s.half.x());
}

std::string linkText(const std::string& link) {
  std::string text = fmt::format("  <link name=\"{}\">\n", link);
  for (const Solid& s : collisionSolids()) {
    if (link != s.link) continue;
    text += fmt::format(
        "    <collision>\n      <origin xyz=\"{}\" rpy=\"{}\"/>\n"
        "      <geometry>{}</geometry>\n    </collision>\n",
        triple(s.centre), triple(rpyOf(s.lie)), geometryOf(s));
  }
  return text + "  </link>\n";
}

std::string jointText(const Joint& j) {
  std::string text = fmt::format(
      "  <joint name=\"{}\" type=\"{}\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n"
      "    <origin xyz=\"{}\" rpy=\"{}\"/>\n",
      j.name, j.type, j.parent, j.child, triple(j.xyz), triple(j.rpy));
  if (std::string(j.type) != "fixed") {
    text += fmt::format(
        "    <axis xyz=\"{}\"/>\n"
        "    <limit lower=\"{:.9g}\" upper=\"{:.9g}\" effort=\"100\" velocity=\"2\"/>\n",
        triple(j.axis), j.low, j.high);
  }
  if (j.mimic[0] != '\0') text += fmt::format("    <mimic joint=\"{}\"/>\n", j.mimic);
  return text + "  </joint>\n";
}

}  // namespace

const std::vector<RobotPart>& robotParts() {
  static const std::vector<RobotPart> kParts = [] {
    std::vector<RobotPart> parts;
    for (const Seen& s : seenSolids()) {
      parts.push_back({s.solid.link, s.solid.kind, s.solid.half,
                       poseOf(s.solid.centre, rpyOf(s.solid.lie)), s.look});
    }
    return parts;
  }();
  return kParts;
}

std::string robotUrdf() {
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<!-- The mobile manipulator of rf-simulate: wheels, mast with a pan-tilt head and camera, "
      "an\n"
      "     arm of six joints, a gripper of two fingers. Collision shapes only. -->\n"
      "<robot name=\"carrier\">\n" +
      linkText(kBaseLink);
  for (const Joint& j : joints()) text += linkText(j.child) + jointText(j);
  return text + "</robot>\n";
}

}  // namespace rf::sim
