// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/conversions.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "random_values.hpp"

namespace rf {
namespace {

constexpr int kTrials = 50;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void expectEqual(const BodyMotion& a, const BodyMotion& b) {
  EXPECT_EQ(a.T_AB, b.T_AB);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.health, b.health);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ(a.rms_residual, b.rms_residual);
}

void expectEqual(const BodyPose& a, const BodyPose& b) {
  EXPECT_EQ(a.T_W, b.T_W);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.health, b.health);
  EXPECT_EQ(a.inliers, b.inliers);
  EXPECT_EQ(a.rms_residual, b.rms_residual);
}

TEST(Conversions, SegmentationIsExactToTheBit) {
  RandomValues random(1);
  for (int i = 0; i < kTrials; ++i) {
    const SegmentationResult s = random.segmentation();
    const auto back = unpack<rigidfusion::segmentation_t>(pack(s));
    ASSERT_TRUE(back) << back.error;
    EXPECT_EQ(back->utime, s.utime);
    EXPECT_EQ(back->utime_a, s.utime_a);
    EXPECT_EQ(back->seq, s.seq);
    EXPECT_EQ(back->reduction, s.reduction);
    EXPECT_EQ(back->first, s.first);
    EXPECT_EQ(back->object_moving, s.object_moving);
    EXPECT_EQ(back->label, s.label);
    EXPECT_EQ(back->score, s.score);
    EXPECT_EQ(back->gamma, s.gamma);
    expectEqual(back->camera, s.camera);
    expectEqual(back->object, s.object);
    EXPECT_EQ(back->dynamic_share, s.dynamic_share);
    EXPECT_EQ(back->hypothesis, s.hypothesis);
    EXPECT_EQ(back->has_prior_T_WC, s.has_prior_T_WC);
    EXPECT_EQ(back->prior_T_WC, s.prior_T_WC);
    EXPECT_EQ(back->has_T_CO, s.has_T_CO);
    EXPECT_EQ(back->T_CO, s.T_CO);
    EXPECT_EQ(back->stage_ms, s.stage_ms);
  }
}

TEST(Conversions, ModelStateIsExactToTheBit) {
  RandomValues random(2);
  for (int i = 0; i < kTrials; ++i) {
    const ModelState s = random.modelState();
    const auto back = unpack<rigidfusion::model_state_t>(pack(s));
    ASSERT_TRUE(back) << back.error;
    EXPECT_EQ(back->utime, s.utime);
    EXPECT_EQ(back->seq, s.seq);
    expectEqual(back->camera, s.camera);
    expectEqual(back->object, s.object);
    EXPECT_EQ(back->object_exists, s.object_exists);
    EXPECT_EQ(back->object_resting, s.object_resting);
    EXPECT_EQ(back->static_surfels, s.static_surfels);
    EXPECT_EQ(back->object_surfels, s.object_surfels);
    EXPECT_EQ(back->reduction, s.reduction);
    EXPECT_EQ(back->predicted_depth_mm, s.predicted_depth_mm);
    EXPECT_EQ(back->body, s.body);
    EXPECT_EQ(back->stage_ms, s.stage_ms);
  }
}

TEST(Conversions, PriorIsExactToTheBit) {
  RandomValues random(3);
  for (int i = 0; i < kTrials; ++i) {
    const MotionPrior p = random.prior();
    const auto back = unpack<rigidfusion::motion_prior_t>(pack(p));
    ASSERT_TRUE(back) << back.error;
    EXPECT_EQ(back->utime_a, p.utime_a);
    EXPECT_EQ(back->utime_b, p.utime_b);
    EXPECT_EQ(back->seq, p.seq);
    EXPECT_EQ(back->camera, p.camera);
    EXPECT_EQ(back->T_CaCb, p.T_CaCb);
    EXPECT_EQ(back->camera_cov, p.camera_cov);
    EXPECT_EQ(back->T_WCb, p.T_WCb);
    EXPECT_EQ(back->object_kind, p.object_kind);
    EXPECT_EQ(back->object, p.object);
    EXPECT_EQ(back->T_XOa, p.T_XOa);
    EXPECT_EQ(back->T_XOb, p.T_XOb);
    EXPECT_EQ(back->object_cov, p.object_cov);
    EXPECT_EQ(back->self, p.self);
  }
}

TEST(Conversions, PriorWithBadShapesIsRefused) {
  const auto problem = [](auto change) {
    MotionPrior p;
    p.self.assign(2, {RobotShapeKind::kBox, Vec3(0.1, 0.2, 0.3), SE3()});
    change(p);
    return toMessage(p).error;
  };
  EXPECT_EQ(problem([](MotionPrior&) {}), "");
  EXPECT_EQ(problem([](MotionPrior& p) { p.self[1].half.y() = 0; }),
            "motion prior: shape's half is 0, must be within 1e-06 to 100");
  EXPECT_EQ(problem([](MotionPrior& p) { p.self[1].kind = static_cast<RobotShapeKind>(3); }),
            "motion prior: shape's kind is 3, must be within 0 to 2");
  EXPECT_NE(problem([](MotionPrior& p) { p.self[0].T_CS.t.x() = NAN; }).find("T_CS is not finite"),
            std::string::npos);
  EXPECT_EQ(problem([](MotionPrior& p) { p.self.resize(257, p.self[0]); }),
            "motion prior: n_shapes is 257, at most 256 are allowed");
}

TEST(Conversions, SmallTypesSurvive) {
  RandomValues random(4);
  for (int i = 0; i < kTrials; ++i) {
    const FrameTick tick = random.tick();
    EXPECT_EQ(*unpack<rigidfusion::frame_tick_t>(pack(tick)).value, tick);
    const CameraInfo camera = random.camera();
    const auto camera_back = unpack<rigidfusion::camera_t>(pack(camera));
    ASSERT_TRUE(camera_back) << camera_back.error;
    EXPECT_EQ(camera_back->camera, camera.camera);
    EXPECT_EQ(camera_back->source, camera.source);
    const Command command = random.command();
    const auto command_back = unpack<rigidfusion::command_t>(pack(command));
    ASSERT_TRUE(command_back) << command_back.error;
    EXPECT_EQ(command_back->kind, command.kind);
    EXPECT_EQ(command_back->chunks, command.chunks);
    const ModelChunk chunk = random.chunk();
    const auto bytes = pack(chunk);
    EXPECT_LE(bytes.size(), 60000U);
    const auto chunk_back = unpack<rigidfusion::model_chunk_t>(bytes);
    ASSERT_TRUE(chunk_back) << chunk_back.error;
    EXPECT_EQ(chunk_back->surfels, chunk.surfels);
    const StampedBodyPose pose = random.bodyPose();
    const auto pose_back = unpack<rigidfusion::body_pose_t>(pack(pose));
    ASSERT_TRUE(pose_back) << pose_back.error;
    expectEqual(pose_back->pose, pose.pose);
  }
}

TEST(Conversions, FramesCarrySeqAsMetadataAndForeignOnesNone) {
  RandomValues random(5);
  for (int i = 0; i < kTrials; ++i) {
    EncodedFrame frame = random.frame();
    if (i % 5 == 0) frame.seq = -1;
    const auto back = unpack<bot_core::images_t>(pack(frame));
    ASSERT_TRUE(back) << back.error;
    EXPECT_EQ(back->utime, frame.utime);
    EXPECT_EQ(back->colour_utime, frame.colour_utime);
    EXPECT_EQ(back->seq, frame.seq);
    EXPECT_EQ(back->colour_format, frame.colour_format);
    EXPECT_EQ(back->colour, frame.colour);
    EXPECT_EQ(back->depth_zipped, frame.depth_zipped);
    EXPECT_EQ(back->depth, frame.depth);
  }
}

TEST(Conversions, ForeignDepthPixelformatsAreAccepted) {
  auto message = toMessage(RandomValues(6).frame());
  ASSERT_TRUE(message);
  for (const int format : std::vector<int>{bot_core::image_t::PIXEL_FORMAT_INVALID,
                                           bot_core::image_t::PIXEL_FORMAT_LE_GRAY16}) {
    message->images[1].pixelformat = format;
    EXPECT_TRUE(toValue(*message));
  }
}

TEST(Conversions, BotPoseKeepsOrderAndNormalises) {
  StampedPose pose{42, RandomValues(7).transform()};
  auto message = toBotPose(pose);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->orientation[0], pose.pose.q.w());
  EXPECT_EQ(message->orientation[3], pose.pose.q.z());
  for (double& q : message->orientation) q *= 1.001;
  const auto back = toValue(*message);
  ASSERT_TRUE(back) << back.error;
  EXPECT_NEAR(back->pose.q.norm(), 1, 1e-12);
  EXPECT_EQ(back->pose.t, pose.pose.t);
}

template <class Value, class Change>
std::string refusal(Value value, const Change& change) {
  change(value);
  const auto message = toMessage(value);
  EXPECT_FALSE(message);
  return message.error;
}

TEST(Conversions, NothingInvalidIsSent) {
  RandomValues random(8);
  const auto s = [&] {
    auto value = random.segmentation();
    value.first = false;
    return value;
  };
  EXPECT_NE(refusal(s(), [](auto& v) { v.camera.T_AB.t.x() = kNan; }).find("T_AB is not finite"),
            std::string::npos);
  EXPECT_NE(refusal(s(), [](auto& v) { v.object.T_AB.q.w() += 0.5; }).find("length"),
            std::string::npos);
  EXPECT_NE(refusal(s(), [](auto& v) { v.camera.covariance(2, 2) = -1; }).find("variance -1"),
            std::string::npos);
  EXPECT_NE(refusal(s(), [](auto& v) { v.camera.health = Health::kInvalid; }).find("health is 0"),
            std::string::npos);
  EXPECT_NE(refusal(s(), [](auto& v) { v.gamma[0] = 2; }).find("gamma is 2"), std::string::npos);
  EXPECT_NE(refusal(s(), [](auto& v) { v.dynamic_share = kNan; }).find("dynamic_share"),
            std::string::npos);
  EXPECT_NE(refusal(s(), [](auto& v) { v.label[0] = 77; }).find("label 77"), std::string::npos);
  EXPECT_NE(refusal(s(),
                    [](auto& v) {
                      v.score = Image<std::uint8_t>(1, 1);
                      v.label = Image<std::uint8_t>(2, 1);
                    })
                .find("differ in size"),
            std::string::npos);
  EXPECT_NE(
      refusal(random.modelState(), [](auto& v) { v.camera.T_W.t.y() = kNan; }).find("not finite"),
      std::string::npos);
  EXPECT_NE(refusal(random.modelState(), [](auto& v) { v.body[0] = 9; }).find("body 9"),
            std::string::npos);
  EXPECT_NE(refusal(random.prior(), [](auto& v) { v.T_XOb.q.x() = kNan; }).find("not finite"),
            std::string::npos);
  EXPECT_NE(refusal(random.prior(), [](auto& v) { v.utime_a = v.utime_b + 1; }).find("later"),
            std::string::npos);
  EXPECT_NE(refusal(random.tick(), [](auto& v) { v.seq = -2; }).find("seq is -2"),
            std::string::npos);
  EXPECT_NE(refusal(random.camera(), [](auto& v) { v.camera.fx = kNan; }).find("fx"),
            std::string::npos);
  EXPECT_NE(refusal(random.frame(), [](auto& v) { v.width = -1; }).find("-1x48"),
            std::string::npos);
}

TEST(Conversions, NothingInvalidIsTaken) {
  RandomValues random(9);
  auto segmentation = toMessage(random.segmentation());
  ASSERT_TRUE(segmentation);
  segmentation->camera.T_AB.quat_wxyz[1] = kNan;
  EXPECT_NE(toValue(*segmentation).error.find("not finite"), std::string::npos);
  segmentation = toMessage(random.segmentation());
  segmentation->width = 8000;
  segmentation->height = 8000;
  EXPECT_NE(toValue(*segmentation).error.find("cannot hold"), std::string::npos);
  segmentation->width = -1;
  EXPECT_NE(toValue(*segmentation).error.find("-1x8000"), std::string::npos);
  auto state = toMessage(random.modelState());
  state->camera.health = 17;
  EXPECT_NE(toValue(*state).error.find("health"), std::string::npos);
  auto prior = toMessage(random.prior());
  prior->object_kind = 5;
  EXPECT_NE(toValue(*prior).error.find("object_kind"), std::string::npos);
  auto tick = toMessage(random.tick());
  tick->state = 9;
  EXPECT_NE(toValue(*tick).error.find("state is 9"), std::string::npos);
  auto command = toMessage(random.command());
  command->command = 0;
  EXPECT_NE(toValue(*command).error.find("command is 0"), std::string::npos);
  auto frame = toMessage(random.frame());
  frame->images[0].width = 320;
  EXPECT_NE(toValue(*frame).error.find("registered"), std::string::npos);
  frame->image_types[1] = bot_core::images_t::DISPARITY;
  EXPECT_NE(toValue(*frame).error.find("DEPTH_MM"), std::string::npos);
  bot_core::pose_t pose{};
  EXPECT_NE(toValue(pose).error.find("length 0"), std::string::npos);
  pose.orientation[0] = 1;
  pose.pos[2] = kNan;
  EXPECT_NE(toValue(pose).error.find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace rf
