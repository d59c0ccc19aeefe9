// SPDX-License-Identifier: BSD-3-Clause
#include "datasets/tum_source.hpp"

#include <utility>

namespace rf {

TumSource::TumSource(const std::string& folder, const std::optional<Calibration>& calibration)
    : dataset_(folder, calibration) {
  prefetch();
}

TumSource::~TumSource() {
  if (pending_.valid()) pending_.wait();
}

void TumSource::prefetch() {
  if (next_ >= dataset_.size()) return;
  pending_ = std::async(std::launch::async, [this, i = next_] { return dataset_.load(i); });
}

std::optional<SourcedFrame> TumSource::next() {
  if (!pending_.valid()) return std::nullopt;
  TumDataset::Loaded loaded = pending_.get();
  const std::size_t i = next_++;
  prefetch();
  return SourcedFrame{dataset_.index().frames[i].utime, static_cast<std::int64_t>(i),
                      std::move(loaded.frame), std::move(loaded.problem)};
}

}  // namespace rf
