// SPDX-License-Identifier: BSD-3-Clause
#include "inputs.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "config/yaml.hpp"
#include "datasets/covariance_table.hpp"
#include "datasets/error.hpp"
#include "datasets/trajectory.hpp"
#include "pipeline/pipeline_config.hpp"
#include "priors/prior_config.hpp"
#include "robot_input.hpp"

namespace rf {
namespace {

namespace fs = std::filesystem;
using calibration::CalibrationRequest;
using calibration::ParameterGroup;
using calibration::Problem;

std::vector<ParameterGroup> groupsOf(Problem problem) {
  std::vector<ParameterGroup> groups = {ParameterGroup::kTranslation, ParameterGroup::kRotation,
                                        ParameterGroup::kTime};
  if (problem == Problem::kOdometry) groups.push_back(ParameterGroup::kScale);
  return groups;
}

ParameterGroup parseGroup(const std::string& word) {
  for (const ParameterGroup g : calibration::kGroups) {
    if (word == calibration::name(g)) return g;
  }
  throw std::invalid_argument(
      fmt::format("--estimate {}: must be translation, rotation, time, scale or turn-scale", word));
}

std::vector<ParameterGroup> askedGroups(const CalibrateOptions& options) {
  if (options.estimate.empty()) return groupsOf(options.problem);
  std::vector<ParameterGroup> asked;
  for (const std::string& word : options.estimate) asked.push_back(parseGroup(word));
  std::sort(asked.begin(), asked.end());
  if (std::adjacent_find(asked.begin(), asked.end()) != asked.end()) {
    throw std::invalid_argument("--estimate: a word is given twice");
  }
  return asked;
}

SE3 parseExtrinsic(const std::vector<double>& v) {
  if (v.size() != 7) {
    throw std::invalid_argument(
        fmt::format("--extrinsic: {} numbers: must be x,y,z,qx,qy,qz,qw", v.size()));
  }
  return toTransform({v[0], v[1], v[2], v[3], v[4], v[5], v[6]}, "--extrinsic");
}

/// Sets the transform that is known before, from options or configuration.
void readPrior(const CalibrateOptions& options, CalibrationRequest* request) {
  request->prior.sigma_translation = options.sigma_translation;
  request->prior.sigma_rotation = options.sigma_rotation_deg * std::numbers::pi / 180;
  request->prior.has_transform = !options.extrinsic.empty() || !options.config.empty();
  if (!options.extrinsic.empty()) {
    request->prior.values.T_AX = parseExtrinsic(options.extrinsic);
  } else if (!options.config.empty()) {
    if (options.problem != Problem::kOdometry) {
      throw std::invalid_argument("--config: only odometry has its prior in a configuration");
    }
    PipelineConfig config;
    loadConfigFile(options.config, config);
    request->prior.values.T_AX = toTransform(config.prior.base_to_camera, "prior.base_to_camera");
  }
}

/// Poses whose health is degraded, prior-only or lost are no measurement.
Trajectory trackedOnes(const Trajectory& poses, const PoseCovariances& states,
                       std::vector<std::string>* notes, const std::string& path) {
  std::set<std::int64_t> bad;
  for (const PoseCovariance& state : states) {
    if (state.health != Health::kTracked) bad.insert(state.utime);
  }
  Trajectory out;
  for (const StampedPose& p : poses) {
    if (!bad.contains(p.utime)) out.push_back(p);
  }
  if (out.empty() && !poses.empty()) {
    throw DatasetError(
        fmt::format("{}: none of {} poses is tracked (covariance.csv): without a "
                    "measured pose there is nothing to calibrate from",
                    path, poses.size()));
  }
  if (out.size() < poses.size()) {
    notes->push_back(fmt::format("{}: {} of {} poses are not tracked and were left out", path,
                                 poses.size() - out.size(), poses.size()));
  }
  return out;
}

/// camera.txt or object.txt of a result folder, tracked poses only, or a trajectory file.
Trajectory readSeen(const std::string& path, const std::string& file,
                    std::vector<std::string>* notes) {
  if (!fs::is_directory(path)) return readTrajectory(path);
  const std::string poses = (fs::path(path) / file).string();
  Trajectory all = readTrajectory(poses);
  const fs::path covariances = fs::path(path) / "covariance.csv";
  if (!fs::exists(covariances)) return all;
  const CovarianceFile states = readCovariances(covariances.string());
  return trackedOnes(all, file == "camera.txt" ? states.camera : states.object, notes, poses);
}

/// T_CO from T_WO and the camera's T_WC of the same moments.
Trajectory inCamera(const Trajectory& objects, const Trajectory& cameras, const std::string& path) {
  Trajectory out;
  auto camera = cameras.begin();
  for (const StampedPose& object : objects) {
    while (camera != cameras.end() && camera->utime < object.utime) ++camera;
    if (camera == cameras.end() || camera->utime != object.utime) continue;
    out.push_back({object.utime, camera->pose.inverse() * object.pose});
  }
  if (out.empty()) {
    throw DatasetError(path + ": no pose has the time of an object pose: must be of one run");
  }
  return out;
}

Trajectory readObject(const CalibrateOptions& options, std::vector<std::string>* notes) {
  Trajectory object = readSeen(options.seen, "object.txt", notes);
  if (!options.same_frame) return object;
  std::string camera = options.camera;
  if (camera.empty() && fs::is_directory(options.seen)) camera = options.seen;
  if (camera.empty()) return object;  // given as T_CO
  return inCamera(object, readSeen(camera, "camera.txt", notes), camera);
}

/// The motion from a robot folder, and the extrinsic of its URDF where none is given.
void readRobot(const CalibrateOptions& options, CalibrateInput* input) {
  const RobotInput robot = readRobotInput(options.robot, options.problem);
  input->A = robot.moving;
  CalibrationRequest& request = input->request;
  if (!request.prior.has_transform && robot.extrinsic) {
    request.prior.values.T_AX = *robot.extrinsic;
    request.prior.has_transform = true;
    input->notes.emplace_back("the prior of the transform is the URDF's");
  }
  if (options.problem == Problem::kGrasp && robot.held.empty()) {
    input->notes.emplace_back("there is no grasp.csv: the object is taken as held all the time");
  }
  if (robot.held.empty()) return;
  const auto before = input->X.size();
  std::erase_if(input->X, [&](const StampedPose& p) {
    return std::none_of(robot.held.begin(), robot.held.end(), [&](const auto& span) {
      return p.utime > span.first && p.utime < span.second;
    });
  });
  const std::string note = fmt::format("{} of {} object poses are of times at which it is held",
                                       input->X.size(), before);
  if (input->X.empty()) throw DatasetError(options.robot + "/grasp.csv: " + note);
  input->notes.push_back(note);
}

}  // namespace

CalibrateInput readInput(const CalibrateOptions& options) {
  CalibrateInput input;
  CalibrationRequest& request = input.request;
  request.problem = options.problem;
  request.asked = askedGroups(options);
  request.largest_offset = options.largest_offset;
  request.same_frame = options.same_frame;
  readPrior(options, &request);
  input.X = options.problem == Problem::kGrasp ? readObject(options, &input.notes)
                                               : readSeen(options.seen, "camera.txt", &input.notes);
  if (options.robot.empty()) {
    input.A = readTrajectory(options.moving);
  } else {
    readRobot(options, &input);
  }
  return input;
}

}  // namespace rf
