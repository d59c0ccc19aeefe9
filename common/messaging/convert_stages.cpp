// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <cstring>
#include <stdexcept>

#include "messaging/check.hpp"
#include "messaging/conversions.hpp"
#include "messaging/convert_parts.hpp"

namespace rf {
namespace {

constexpr int kZlibLevel = 1;

template <class T>
std::vector<std::uint8_t> zipPlane(const Image<T>& plane) {
  return deflateBytes(
      {reinterpret_cast<const std::uint8_t*>(plane.data()), plane.size() * sizeof(T)}, kZlibLevel);
}

/// Checks the claimed size, then restores the plane.
template <class T>
Image<T> unzipPlane(Check& check, const char* member, const std::vector<std::uint8_t>& zipped,
                    int width, int height) {
  if (!check.good()) return {};
  const bool empty = width == 0 && height == 0;
  if (!empty && (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide)) {
    check.rule(false, fmt::format("{} is {}x{}, must be 1 to {} pixels a side", member, width,
                                  height, kMaxImageSide));
    return {};
  }
  const std::size_t bytes =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * sizeof(T);
  const auto plane = inflateBytes(zipped, bytes);
  if (!plane) {
    check.rule(false, fmt::format("{}: {}", member, plane.error));
    return {};
  }
  Image<T> out(width, height);
  if (bytes > 0) std::memcpy(out.data(), plane->data(), bytes);
  return out;
}

bool planeFits(int width, int height) { return width <= kMaxImageSide && height <= kMaxImageSide; }

void checkMotion(Check& check, const BodyMotion& motion, bool first) {
  check.transform("T_AB", motion.T_AB);
  check.covariance("covariance", motion.covariance);
  check.health("health", motion.health, first);
  check.nonNegative("inliers", motion.inliers);
  check.nonNegative("rms_residual", motion.rms_residual);
}

void checkPose(Check& check, const BodyPose& pose, bool exists) {
  check.transform("T_W", pose.T_W);
  check.covariance("covariance", pose.covariance);
  check.health("health", pose.health, !exists);
  check.nonNegative("inliers", pose.inliers);
  check.nonNegative("rms_residual", pose.rms_residual);
}

void checkValue(Check& check, const SegmentationResult& s) {
  check.range("reduction", s.reduction, 1, 64);
  checkMotion(check, s.camera, s.first);
  checkMotion(check, s.object, s.first);
  check.range("dynamic_share", s.dynamic_share, 0, 1);
  check.range("self_share", s.self_share, 0, 1);
  check.range("self_behind", s.self_behind, 0, 1);
  check.text("hypothesis", s.hypothesis);
  if (s.has_prior_T_WC) check.transform("prior_T_WC", s.prior_T_WC);
  if (s.has_T_CO) check.transform("T_CO", s.T_CO);
  check.stageTimes(s.stage_ms);
  check.rule(s.gamma.size() <= kMaxClusters,
             fmt::format("{} clusters, at most {} are allowed", s.gamma.size(), kMaxClusters));
  for (const float g : s.gamma) check.range("gamma", g, 0, 1);
  for (const std::uint8_t label : s.label) {
    if (label < kMaxClusters && label >= s.gamma.size()) {
      check.rule(false, fmt::format("a pixel has label {}, but there are {} clusters", label,
                                    s.gamma.size()));
      break;
    }
  }
}

void checkValue(Check& check, const ModelState& s) {
  checkPose(check, s.camera, true);
  checkPose(check, s.object, s.object_exists);
  check.range("reduction", s.reduction, 1, 64);
  check.rule(s.static_surfels >= 0 && s.object_surfels >= 0, "a negative number of surfels");
  check.stageTimes(s.stage_ms);
  for (const std::uint8_t body : s.body) {
    if (body > kBodyObject) {
      check.rule(false, fmt::format("a pixel has body {}, must be 0, 1 or 2", body));
      break;
    }
  }
}

void checkState(Check& check, const char* member, PriorState state) {
  check.range(member, static_cast<int>(state), 0, 2);
}

void checkValue(Check& check, const MotionPrior& p) {
  check.rule(p.utime_a <= p.utime_b,
             fmt::format("utime_a {} is later than utime_b {}", p.utime_a, p.utime_b));
  check.rule(p.seq >= 0, fmt::format("seq is {}, must not be negative", p.seq));
  checkState(check, "camera_state", p.camera);
  checkState(check, "object_state", p.object);
  check.range("object_kind", static_cast<int>(p.object_kind), 0, 2);
  check.transform("T_CaCb", p.T_CaCb);
  check.covariance("camera_covariance", p.camera_cov);
  check.transform("T_WCb", p.T_WCb);
  check.transform("T_XOa", p.T_XOa);
  check.transform("T_XOb", p.T_XOb);
  check.covariance("object_covariance", p.object_cov);
  check.rule(p.self.size() <= kMaxRobotShapes,
             fmt::format("n_shapes is {}, at most {} are allowed", p.self.size(), kMaxRobotShapes));
  for (const PosedShape& shape : p.self) {
    check.range("shape's kind", static_cast<int>(shape.kind), 0, 2);
    for (const double half : shape.half) check.range("shape's half", half, 1e-6, 100);
    check.transform("shape's T_CS", shape.T_CS);
  }
}

rigidfusion::robot_shape_t toWire(const PosedShape& shape) {
  rigidfusion::robot_shape_t out;
  out.kind = static_cast<std::int32_t>(shape.kind);
  for (int i = 0; i < 3; ++i) out.half[i] = shape.half[i];
  out.T_CS = rf::toWire(shape.T_CS);
  return out;
}

rigidfusion::body_motion_t toWire(const BodyMotion& motion) {
  rigidfusion::body_motion_t out;
  out.T_AB = rf::toWire(motion.T_AB);
  rf::toWire(motion.covariance, out.covariance);
  out.health = static_cast<std::int32_t>(motion.health);
  out.inliers = motion.inliers;
  out.rms_residual = motion.rms_residual;
  return out;
}

Health healthOf(std::int32_t wire) {
  return static_cast<Health>(wire >= 0 && wire <= 4 ? wire : -1);  // -1: the value check says so
}

BodyMotion fromWire(const rigidfusion::body_motion_t& in) {
  BodyMotion out;
  out.T_AB = rf::fromWire(in.T_AB);
  out.covariance = rf::fromWire(in.covariance);
  out.health = healthOf(in.health);
  out.inliers = in.inliers;
  out.rms_residual = in.rms_residual;
  return out;
}

rigidfusion::body_pose_t toWire(std::int64_t utime, std::int64_t seq, const BodyPose& pose) {
  rigidfusion::body_pose_t out;
  out.utime = utime;
  out.seq = seq;
  out.T_W = rf::toWire(pose.T_W);
  rf::toWire(pose.covariance, out.covariance);
  out.health = static_cast<std::int32_t>(pose.health);
  out.inliers = pose.inliers;
  out.rms_residual = pose.rms_residual;
  return out;
}

BodyPose fromWire(const rigidfusion::body_pose_t& in) {
  BodyPose out;
  out.T_W = rf::fromWire(in.T_W);
  out.covariance = rf::fromWire(in.covariance);
  out.health = healthOf(in.health);
  out.inliers = in.inliers;
  out.rms_residual = in.rms_residual;
  return out;
}

template <class State>
State stateOf(std::int32_t wire) {
  return static_cast<State>(wire >= 0 && wire <= 2 ? wire : -1);
}

}  // namespace

Result<rigidfusion::segmentation_t> toMessage(const SegmentationResult& s) {
  Check check("segmentation");
  checkValue(check, s);
  check.rule(s.label.width() == s.score.width() && s.label.height() == s.score.height(),
             "label and score differ in size");
  check.rule(planeFits(s.label.width(), s.label.height()), "planes are too large");
  if (!check.good()) return Result<rigidfusion::segmentation_t>::failure(check.problem());
  rigidfusion::segmentation_t out;
  out.utime = s.utime;
  out.utime_a = s.utime_a;
  out.seq = s.seq;
  out.reduction = s.reduction;
  out.first = static_cast<std::int8_t>(s.first);
  out.object_moving = static_cast<std::int8_t>(s.object_moving);
  out.turned = static_cast<std::int8_t>(s.turned);
  out.world_told = static_cast<std::int8_t>(s.world_told);
  out.width = s.label.width();
  out.height = s.label.height();
  out.label_zlib = zipPlane(s.label);
  out.label_size = static_cast<std::int32_t>(out.label_zlib.size());
  out.score_zlib = zipPlane(s.score);
  out.score_size = static_cast<std::int32_t>(out.score_zlib.size());
  out.gamma = s.gamma;
  out.n_clusters = static_cast<std::int32_t>(s.gamma.size());
  out.camera = toWire(s.camera);
  out.object = toWire(s.object);
  out.dynamic_share = s.dynamic_share;
  out.self_share = s.self_share;
  out.self_behind = s.self_behind;
  out.hypothesis = s.hypothesis;
  out.has_prior_T_WC = static_cast<std::int8_t>(s.has_prior_T_WC);
  out.prior_T_WC = toWire(s.has_prior_T_WC ? s.prior_T_WC : SE3());
  out.has_T_CO = static_cast<std::int8_t>(s.has_T_CO);
  out.T_CO = toWire(s.has_T_CO ? s.T_CO : SE3());
  stagesToWire(s.stage_ms, out);
  return out;
}

Result<SegmentationResult> toValue(const rigidfusion::segmentation_t& m) {
  Check check("segmentation_t");
  SegmentationResult out;
  out.utime = m.utime;
  out.utime_a = m.utime_a;
  out.seq = m.seq;
  out.reduction = m.reduction;
  out.first = m.first != 0;
  out.object_moving = m.object_moving != 0;
  out.turned = m.turned != 0;
  out.world_told = m.world_told != 0;
  out.label = unzipPlane<std::uint8_t>(check, "label", m.label_zlib, m.width, m.height);
  out.score = unzipPlane<std::uint8_t>(check, "score", m.score_zlib, m.width, m.height);
  out.gamma = m.gamma;
  out.camera = fromWire(m.camera);
  out.object = fromWire(m.object);
  out.dynamic_share = m.dynamic_share;
  out.self_share = m.self_share;
  out.self_behind = m.self_behind;
  out.hypothesis = m.hypothesis;
  out.has_prior_T_WC = m.has_prior_T_WC != 0;
  out.prior_T_WC = rf::fromWire(m.prior_T_WC);
  out.has_T_CO = m.has_T_CO != 0;
  out.T_CO = rf::fromWire(m.T_CO);
  out.stage_ms = stagesFromWire(m);
  checkValue(check, out);
  if (!check.good()) return Result<SegmentationResult>::failure(check.problem());
  return out;
}

Result<rigidfusion::model_state_t> toMessage(const ModelState& s) {
  Check check("model state");
  checkValue(check, s);
  check.rule(s.predicted_depth_mm.width() == s.body.width() &&
                 s.predicted_depth_mm.height() == s.body.height(),
             "predicted depth and body plane differ in size");
  check.rule(planeFits(s.body.width(), s.body.height()), "planes are too large");
  if (!check.good()) return Result<rigidfusion::model_state_t>::failure(check.problem());
  rigidfusion::model_state_t out;
  out.utime = s.utime;
  out.seq = s.seq;
  out.camera = toWire(s.utime, s.seq, s.camera);
  out.object_exists = static_cast<std::int8_t>(s.object_exists);
  out.object_resting = static_cast<std::int8_t>(s.object_resting);
  out.object = toWire(s.utime, s.seq, s.object);
  out.static_surfels = s.static_surfels;
  out.object_surfels = s.object_surfels;
  out.reduction = s.reduction;
  out.width = s.body.width();
  out.height = s.body.height();
  out.depth_zlib = zipPlane(s.predicted_depth_mm);
  out.depth_size = static_cast<std::int32_t>(out.depth_zlib.size());
  out.body_zlib = zipPlane(s.body);
  out.body_size = static_cast<std::int32_t>(out.body_zlib.size());
  stagesToWire(s.stage_ms, out);
  return out;
}

Result<ModelState> toValue(const rigidfusion::model_state_t& m) {
  Check check("model_state_t");
  ModelState out;
  out.utime = m.utime;
  out.seq = m.seq;
  out.camera = fromWire(m.camera);
  out.object_exists = m.object_exists != 0;
  out.object_resting = m.object_resting != 0;
  out.object = fromWire(m.object);
  out.static_surfels = m.static_surfels;
  out.object_surfels = m.object_surfels;
  out.reduction = m.reduction;
  out.predicted_depth_mm =
      unzipPlane<std::uint16_t>(check, "predicted depth", m.depth_zlib, m.width, m.height);
  out.body = unzipPlane<std::uint8_t>(check, "body", m.body_zlib, m.width, m.height);
  out.stage_ms = stagesFromWire(m);
  checkValue(check, out);
  if (!check.good()) return Result<ModelState>::failure(check.problem());
  return out;
}

Result<rigidfusion::motion_prior_t> toMessage(const MotionPrior& p) {
  Check check("motion prior");
  checkValue(check, p);
  if (!check.good()) return Result<rigidfusion::motion_prior_t>::failure(check.problem());
  rigidfusion::motion_prior_t out;
  out.utime = p.utime_b;
  out.utime_a = p.utime_a;
  out.seq = p.seq;
  out.camera_state = static_cast<std::int32_t>(p.camera);
  out.T_CaCb = toWire(p.T_CaCb);
  toWire(p.camera_cov, out.camera_covariance);
  out.T_WCb = toWire(p.T_WCb);
  out.object_kind = static_cast<std::int32_t>(p.object_kind);
  out.object_state = static_cast<std::int32_t>(p.object);
  out.T_XOa = toWire(p.T_XOa);
  out.T_XOb = toWire(p.T_XOb);
  toWire(p.object_cov, out.object_covariance);
  for (const PosedShape& shape : p.self) out.shapes.push_back(toWire(shape));
  out.n_shapes = static_cast<std::int32_t>(p.self.size());
  return out;
}

Result<MotionPrior> toValue(const rigidfusion::motion_prior_t& m) {
  MotionPrior out;
  out.utime_b = m.utime;
  out.utime_a = m.utime_a;
  out.seq = m.seq;
  out.camera = stateOf<PriorState>(m.camera_state);
  out.T_CaCb = rf::fromWire(m.T_CaCb);
  out.camera_cov = rf::fromWire(m.camera_covariance);
  out.T_WCb = rf::fromWire(m.T_WCb);
  out.object_kind = stateOf<ObjectPriorKind>(m.object_kind);
  out.object = stateOf<PriorState>(m.object_state);
  out.T_XOa = rf::fromWire(m.T_XOa);
  out.T_XOb = rf::fromWire(m.T_XOb);
  out.object_cov = rf::fromWire(m.object_covariance);
  for (const auto& shape : m.shapes) {
    out.self.push_back({stateOf<RobotShapeKind>(shape.kind),
                        Vec3(shape.half[0], shape.half[1], shape.half[2]),
                        rf::fromWire(shape.T_CS)});
  }
  Check check("motion_prior_t");
  checkValue(check, out);
  if (!check.good()) return Result<MotionPrior>::failure(check.problem());
  return out;
}

Result<rigidfusion::body_pose_t> toMessage(const StampedBodyPose& p) {
  Check check("body pose");
  checkPose(check, p.pose, false);
  if (!check.good()) return Result<rigidfusion::body_pose_t>::failure(check.problem());
  return toWire(p.utime, p.seq, p.pose);
}

Result<StampedBodyPose> toValue(const rigidfusion::body_pose_t& m) {
  Check check("body_pose_t");
  const StampedBodyPose out{m.utime, m.seq, fromWire(m)};
  checkPose(check, out.pose, false);
  if (!check.good()) return Result<StampedBodyPose>::failure(check.problem());
  return out;
}

}  // namespace rf
