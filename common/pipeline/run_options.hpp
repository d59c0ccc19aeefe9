// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace rf {

/// What rf-run and rf-launch are asked to do: the same options, the same meaning.
struct RunOptions {
  std::string input;   ///< TUM-layout folder, an LCM log with OPENNI_FRAME, or an .oni file
  std::string device;  ///< rf-launch, instead of an input: OpenNI2 device by URI, or "any"
  std::string output;  ///< result folder
  std::string
      camera_prior;  ///< trajectory file, "none", or empty: odometry.txt of the input if present
  std::string object_prior;  ///< trajectory file, "none", or empty: object_odometry.txt if present
  std::string robot;         ///< robot folder, "none", or empty: robot/ of the input if present
  std::string calibration;   ///< camera.yaml; empty: that of the input
  std::vector<double>
      simulate_drift;  ///< V,W[,V,W]: m/s and rad/s, camera then object; empty = none
  std::uint64_t drift_seed = 1;
  std::string mode;  ///< segmentation.mode; empty = the configuration's
  int threads = 2;
  std::string config;            ///< YAML file; empty = defaults
  std::vector<std::string> set;  ///< overrides, section.key=value
  bool write_masks = false;
  bool quiet = false;

  /// The robot folder in force, empty when there is none. It gives the camera's and the object's
  /// prior unless --camera-prior or --object-prior say otherwise ("none" included).
  std::string robotFolder() const;
  bool robotGivesCamera() const { return !robotFolder().empty() && camera_prior.empty(); }
  bool robotGivesObject() const { return !robotFolder().empty() && object_prior.empty(); }
  /// The prior file in force: the option's, else nothing when the robot gives that prior, else
  /// `fallback` in the input folder when it exists, else empty (no prior).
  std::string cameraPriorFile() const;
  std::string objectPriorFile() const;
  /// Empty when usable, else what is wrong, naming option, value and rule.
  std::string problem() const;
};

}  // namespace rf
