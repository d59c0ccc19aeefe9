// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace rf {

/// A value, or the reason why there is none. Bad input is an expected outcome, so it is data.
template <typename T>
struct Result {
  std::optional<T> value;
  std::string error;  ///< empty exactly when there is a value

  Result(T good) : value(std::move(good)) {}  // NOLINT(google-explicit-constructor)
  static Result failure(std::string why) { return Result(std::move(why), 0); }

  explicit operator bool() const { return value.has_value(); }
  const T& operator*() const { return *value; }
  T& operator*() { return *value; }
  const T* operator->() const { return &*value; }
  T* operator->() { return &*value; }

 private:
  Result(std::string why, int) : error(std::move(why)) {}
};

}  // namespace rf
