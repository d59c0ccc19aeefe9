// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

namespace rf {

/// A file that cannot be used. The text names file, line or field, value and the violated rule.
class DatasetError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace rf
