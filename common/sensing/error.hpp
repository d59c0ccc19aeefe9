// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace rf {

/// A device or .oni file that cannot be used. The text names it, what was asked for, what it said,
/// and what to check.
class SensingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rf
