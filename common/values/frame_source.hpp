// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "geometry/camera.hpp"
#include "values/frame.hpp"

namespace rf {

/// One input frame, or why it could not be used.
struct SourcedFrame {
  std::int64_t utime = 0;
  std::int64_t seq = 0;
  std::optional<RgbdFrame> frame;
  std::string problem;  ///< when there is no frame: names the file or message and what is wrong
  bool coded = false;   ///< colour already went through the codec (logs): not to be coded again
};

/// A recording, frame by frame. Implementations: TUM-layout folders, LCM logs.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const Camera& camera() const = 0;
  /// Number of frames if known, else 0.
  virtual std::size_t size() const = 0;
  /// The next frame in time order; empty at the end.
  virtual std::optional<SourcedFrame> next() = 0;
};

}  // namespace rf
