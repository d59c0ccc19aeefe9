// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "values/frame.hpp"

namespace rf {

class TumDataset;

/// What the test driver shows: a TUM-layout folder with its own times, or a pattern that differs in
/// every frame (utime: 33333 us apart, colour 4 ms after depth).
class DriverScene {
 public:
  /// Empty: the pattern. Throws DatasetError, ConfigError.
  explicit DriverScene(const std::string& folder = {});
  ~DriverScene();
  DriverScene(const DriverScene&) = delete;
  DriverScene& operator=(const DriverScene&) = delete;

  /// Number of frames; the pattern never ends (0).
  int size() const;
  /// Frame i; a size other than the folder's, or a frame that cannot be read, gives the pattern.
  RgbdFrame frame(int i, int width, int height) const;

 private:
  std::unique_ptr<TumDataset> folder_;
};

/// Frame i of the pattern; depth is 0 or within 400..9999 mm.
RgbdFrame patternFrame(int i, int width, int height);

}  // namespace rf
