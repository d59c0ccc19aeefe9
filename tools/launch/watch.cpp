// SPDX-License-Identifier: BSD-3-Clause
#include "watch.hpp"

#include <fmt/format.h>

#include "messaging/conversions.hpp"

namespace rf {

using rigidfusion::service_status_t;

Watch::Watch(const std::string& state_url)
    : bus_(state_url, ""), status_box_(inbox_.addBox(64)), state_box_(inbox_.addBox(64)) {
  bus_.subscribe("RF_STATUS_.*", inbox_, status_box_);
  bus_.subscribe("RF_MODEL_STATE", inbox_, state_box_);
  bus_.start();
}

void Watch::update(std::chrono::milliseconds timeout) {
  inbox_.waitForNews(timeout);
  while (const auto raw = inbox_.pop(status_box_)) {
    auto status = decodeMessage<service_status_t>(raw->bytes);
    if (status) statuses_[status->service] = std::move(*status);
  }
  while (const auto raw = inbox_.pop(state_box_)) {
    const auto state = unpack<rigidfusion::model_state_t>(raw->bytes);
    if (!state || state->seq == last_seq_) continue;
    last_seq_ = state->seq;
    ++results_;
    last_result_ = fmt::format("camera {}, object {}", name(state->camera.health),
                               state->object_exists ? name(state->object.health) : "unborn");
  }
}

bool Watch::ready(const std::string& service) const {
  const auto it = statuses_.find(service);
  return it != statuses_.end() && it->second.state >= service_status_t::WAITING &&
         it->second.state <= service_status_t::DEGRADED;
}

}  // namespace rf
