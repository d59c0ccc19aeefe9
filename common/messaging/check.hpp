// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "geometry/se3.hpp"
#include "values/health.hpp"
#include "values/segmentation_result.hpp"

namespace rf {

/// Collects the first fault of a message or value: member, value and violated rule.
class Check {
 public:
  explicit Check(std::string what) : what_(std::move(what)) {}

  void rule(bool holds, const std::string& problem);
  void finite(const char* member, double value);
  void nonNegative(const char* member, double value);
  void range(const char* member, double value, double low, double high);
  /// Finite, quaternion of unit length.
  void transform(const char* member, const SE3& T);
  /// Finite, no negative variance.
  void covariance(const char* member, const Mat6& covariance);
  void health(const char* member, Health health, bool may_be_invalid);
  void stageTimes(const StageTimes& times);
  /// A name or sentence: at most 4096 bytes, no zero byte (C++ strings may hold one, LCM's may
  /// not).
  void text(const char* member, const std::string& value);

  bool good() const { return problem_.empty(); }
  const std::string& problem() const { return problem_; }

 private:
  std::string what_;
  std::string problem_;
};

}  // namespace rf
