// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace rf {

/// A robot's description, or what is asked of it, is wrong. The text names source, element, value
/// and rule.
class KinematicsError : public std::runtime_error {
 public:
  KinematicsError(const std::string& source, const std::string& problem)
      : std::runtime_error(source + ": " + problem) {}
};

}  // namespace rf
