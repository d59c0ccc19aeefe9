// SPDX-License-Identifier: BSD-3-Clause
// rf-prior beside a live robot: joints, twists and grasps by message, good ones and bad ones.
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "kinematics/robot_model.hpp"
#include "messaging/conversions.hpp"
#include "messaging/robot_samples.hpp"
#include "pipeline_fixture.hpp"
#include "robot_folder.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;
constexpr std::chrono::seconds kLongest(60);
constexpr double kFloat = 1e-5;  // joint_state_t carries floats

class RobotLive : public PipelineTest {
 protected:
  static void SetUpTestSuite() {
    folder_ = fs::temp_directory_path() / ("rf-robot-" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }

  RobotLive() : priors_(inbox_.addBox(64)), bus_(kState, kState) {
    bus_.subscribe("RF_MOTION_PRIOR", inbox_, priors_);
    bus_.start();
  }

  /// The robot of urdfManipulator() with these lines more in its robot.yaml.
  std::string robotFolder(const std::string& more = "") {
    const std::string folder = own("robot");
    fs::create_directories(folder);
    std::ofstream(folder + "/robot.urdf") << urdfManipulator();
    std::ofstream(folder + "/robot.yaml")
        << "base_link: base\ncamera_link: camera\ngripper_link: gripper\n"
        << "channels: {odometry: RF_BASE_TWIST, odometry_type: planar_twist_t}\n"
        << more;
    return folder;
  }
  void startPrior(const std::string& wait_ms = "2000") {
    start("prior", {"--robot", robotFolder(), "--robot-live", "--wait-ms", wait_ms});
    watch_ = std::make_unique<Watch>(kState);
    awaitReady(*watch_);
  }

  void send(const std::string& channel, const Bytes& bytes) {
    ASSERT_EQ(bus_.publish(channel, bytes), "") << channel;
  }
  static std::int64_t us(double t) { return std::llround(1e6 * (1000 + t)); }
  static JointPositions jointsAt(double t) {
    return {{"pan", 0.4 * t}, {"tilt", -0.2 * t}, {"lift", 0.05 * t}, {"elbow", 0.6 * t}};
  }
  void sendTwist(double t) { send("RF_BASE_TWIST", packTwist(us(t), {0.3, 0, 0.5})); }
  void sendJoints(double t) {
    RobotSample::Joints joints;
    for (const auto& [name, position] : jointsAt(t)) {
      joints.names.push_back(name);
      joints.positions.push_back(position);
    }
    send("CORE_ROBOT_STATE", packJoints(us(t), joints));
  }
  /// Everything that the robot says in (from, to].
  void drive(double from, double to) {
    for (double t = from + 0.01; t < to + 1e-9; t += 0.01) {
      sendTwist(t);
      sendJoints(t);
    }
  }
  /// The prior that answers a tick at that time.
  MotionPrior priorAt(double t) {
    send("RF_FRAME_TICK", pack(FrameTick{us(t), us(t), ++seq_, TickState::kPublished, ""}));
    const auto until = std::chrono::steady_clock::now() + kLongest;
    while (std::chrono::steady_clock::now() < until) {
      while (const auto raw = inbox_.pop(priors_)) {
        const auto prior = unpack<rigidfusion::motion_prior_t>(raw->bytes);
        EXPECT_TRUE(prior) << prior.error;
        if (prior && prior->utime_b == us(t)) return *prior;
      }
      inbox_.waitForNews(std::chrono::milliseconds(50));
    }
    ADD_FAILURE() << "no prior for " << t << "; rf-prior said:\n" << logOf("prior");
    return {};
  }
  /// Waits until that many bad inputs were counted.
  void expectBadInputs(std::int64_t wanted) {
    const auto until = std::chrono::steady_clock::now() + kLongest;
    std::int64_t found = -1;
    while (found < wanted && std::chrono::steady_clock::now() < until) {
      watch_->update(std::chrono::milliseconds(50));
      const auto status = watch_->statuses().find("prior");
      if (status != watch_->statuses().end()) found = status->second.n_bad_input;
    }
    EXPECT_EQ(found, wanted) << logOf("prior");
  }

  RobotModel robot_ = RobotModel::fromUrdf(urdfManipulator(), "robot.urdf");
  std::int64_t seq_ = -1;
  Inbox inbox_;
  Inbox::Box priors_;
  Bus bus_;
  std::unique_ptr<Watch> watch_;
};

SE3 baseAt(double t) { return arc({0.3, 0, 0.5}, t); }

void expectNear(const SE3& a, const SE3& b) {
  EXPECT_LT((a.inverse() * b).log().norm(), kFloat)
      << a.t.transpose() << " and " << b.t.transpose();
}

TEST_F(RobotLive, GivesCameraObjectAndShapes) {
  startPrior();
  sendTwist(0);
  sendJoints(0);
  drive(0, 0.3);
  EXPECT_EQ(priorAt(0.205).camera, PriorState::kValid);
  const SE3 T_GO(Eigen::Quaterniond::Identity(), Vec3(0.1, 0, 0.05));
  send("RF_GRASP", packGrasp({us(0.22), true, T_GO}));
  // Frames between samples wait for the sample after them.
  MotionPrior prior = priorAt(0.238);
  EXPECT_EQ(prior.object, PriorState::kMissing);  // held at one end only
  prior = priorAt(0.271);
  ASSERT_EQ(prior.camera, PriorState::kValid);
  const auto T_WC = [&](double t) {
    return baseAt(t) * robot_.T_AB("base", "camera", jointsAt(t));
  };
  expectNear(prior.T_CaCb, T_WC(0.238).inverse() * T_WC(0.271));
  expectNear(prior.T_WCb, T_WC(0.271));
  ASSERT_EQ(prior.object, PriorState::kValid);
  EXPECT_EQ(prior.object_kind, ObjectPriorKind::kCameraFrame);
  expectNear(prior.T_XOb, robot_.T_AB("camera", "gripper", jointsAt(0.271)) * T_GO);
  EXPECT_EQ(prior.self.size(), 3U);
  send("RF_GRASP", packGrasp({us(0.28), false, SE3()}));
  EXPECT_EQ(priorAt(0.299).object, PriorState::kMissing);
  stopAll();
  EXPECT_NE(logOf("prior").find("the object is held"), std::string::npos) << logOf("prior");
}

TEST_F(RobotLive, BadMessagesAreSaidAndCountedAndThePipelineGoesOn) {
  startPrior();
  sendTwist(0);
  sendJoints(0);
  drive(0, 0.1);
  EXPECT_EQ(priorAt(0.05).camera, PriorState::kValid);
  const Bytes garbage(300, 0xA5);
  send("CORE_ROBOT_STATE", packJoints(us(0.101), {{"arm_1", "arm_2"}, {1, 2}}));
  expectBadInputs(1);  // said; what follows within a second is only counted
  send("CORE_ROBOT_STATE", packJoints(us(0.102), {{"pan", "tilt"}, {NAN, 0}}));
  send("CORE_ROBOT_STATE", packJoints(us(0.05), {{"pan"}, {0}}));  // time goes backwards
  send("CORE_ROBOT_STATE", garbage);
  send("RF_BASE_TWIST", packTwist(us(0.103), {NAN, 0, 0}));
  send("RF_BASE_TWIST", packTwist(us(0.104), {50, 0, 0}));
  send("RF_BASE_TWIST", packTwist(us(0.02), {0, 0, 0}));
  send("RF_BASE_TWIST", garbage);
  send("RF_GRASP", packGrasp({us(0.05), true, SE3(Eigen::Quaterniond(2, 0, 0, 0), Vec3::Zero())}));
  send("RF_GRASP", garbage);
  expectBadInputs(10);
  drive(0.11, 0.2);
  const MotionPrior prior = priorAt(0.195);
  EXPECT_EQ(prior.camera, PriorState::kValid);
  expectNear(prior.T_WCb, baseAt(0.195) * robot_.T_AB("base", "camera", jointsAt(0.195)));
  stopAll();
  EXPECT_NE(logOf("prior").find("it has none of the joints elbow, lift, pan, tilt; it has arm_1, "
                                "arm_2"),
            std::string::npos)
      << logOf("prior");
}

TEST_F(RobotLive, SilenceIsFlaggedAfterABoundedWait) {
  startPrior("100");
  sendTwist(0);
  sendJoints(0);
  drive(0, 0.1);
  EXPECT_EQ(priorAt(0.05).camera, PriorState::kValid);
  for (double t = 0.11; t < 0.505; t += 0.01) sendTwist(t);  // the joints fall silent
  EXPECT_EQ(priorAt(0.15).camera, PriorState::kExtrapolated);
  const MotionPrior missing = priorAt(0.4);
  EXPECT_EQ(missing.camera, PriorState::kMissing);
  EXPECT_TRUE(missing.self.empty());
  for (double t = 0.41; t < 0.505; t += 0.01) sendJoints(t);
  priorAt(0.45);
  EXPECT_EQ(priorAt(0.48).camera, PriorState::kValid);
  stopAll();
  EXPECT_NE(logOf("prior").find("after the newest sample"), std::string::npos) << logOf("prior");
}

TEST_F(RobotLive, OtherTypesByConfiguration) {
  start("prior", {"--robot", robotFolder(), "--robot-live", "--wait-ms", "2000", "--set",
                  "prior.robot.channels.odometry=POSE_BODY", "--set",
                  "prior.robot.channels.odometry_type=pose_t"});
  watch_ = std::make_unique<Watch>(kState);
  awaitReady(*watch_);
  for (double t = 0; t < 0.205; t += 0.01) {
    send("POSE_BODY", encodeMessage(*toBotPose({us(t), baseAt(t)})));
    sendJoints(t);
  }
  priorAt(0.15);
  const MotionPrior prior = priorAt(0.19);
  EXPECT_EQ(prior.camera, PriorState::kValid);
  expectNear(prior.T_WCb, baseAt(0.19) * robot_.T_AB("base", "camera", jointsAt(0.19)));
  stopAll();
}

TEST_F(RobotLive, BadConfigurationEndsAtOnceWithAReason) {
  const auto refused = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"--state-in", kState, "--bulk-in", kBulk};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run("rf-prior", arguments, own("said.txt")), 2);
    return contentOf(own("said.txt"));
  };
  const std::string folder = robotFolder();
  EXPECT_NE(refused({"--robot-live"}).find("--robot-live needs --robot"), std::string::npos);
  EXPECT_NE(refused({"--robot", folder, "--robot-live", "--set",
                     "prior.robot.channels.odometry_type=twist"})
                .find("odometry_type = twist: must be one of"),
            std::string::npos);
  std::ofstream(folder + "/robot.urdf") << "<robot name='x'></robot>";
  EXPECT_NE(refused({"--robot", folder, "--robot-live"}).find("not a usable URDF"),
            std::string::npos);
}

}  // namespace
}  // namespace rf
