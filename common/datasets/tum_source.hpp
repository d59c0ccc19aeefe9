// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <future>
#include <optional>
#include <string>

#include "datasets/tum.hpp"
#include "values/frame_source.hpp"

namespace rf {

/// A TUM-layout folder as a stream of frames. The next frame is read and decoded in a thread of its
/// own while the caller works on this one.
class TumSource : public FrameSource {
 public:
  /// Throws DatasetError or ConfigError, see TumDataset.
  explicit TumSource(const std::string& folder,
                     const std::optional<Calibration>& calibration = std::nullopt);
  ~TumSource() override;
  TumSource(const TumSource&) = delete;
  TumSource& operator=(const TumSource&) = delete;

  const Camera& camera() const override { return dataset_.calibration().camera; }
  std::size_t size() const override { return dataset_.size(); }
  std::optional<SourcedFrame> next() override;

 private:
  void prefetch();

  TumDataset dataset_;
  std::size_t next_ = 0;
  std::future<TumDataset::Loaded> pending_;
};

}  // namespace rf
