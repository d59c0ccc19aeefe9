// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/bus.hpp"

#include <fmt/format.h>

#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <mutex>
#include <optional>
#include <regex>
#include <thread>

#include "messaging/log_file.hpp"
#include "messaging/net_check.hpp"

namespace rf {
namespace {

/// liblcm's own queue between its thread and ours; ours empties it at once.
constexpr int kLcmQueue = 256;
constexpr int kPollMs = 50;

bool isUdpm(const std::string& url) { return url.rfind("udpm://", 0) == 0; }

/// Value of ?key=value in a URL.
std::optional<std::string> optionOf(const std::string& url, const std::string& key) {
  std::smatch match;
  const std::regex pattern("[?&]" + key + "=([^&]*)");
  if (!std::regex_search(url, match, pattern)) return std::nullopt;
  return match[1].str();
}

double speedOf(const std::string& url) {
  const auto text = optionOf(url, "speed");
  if (!text) return 0;
  char* end = nullptr;
  const double speed = std::strtod(text->c_str(), &end);
  if (end == text->c_str() || *end != 0 || !(speed >= 0)) {
    throw BusError(url + ": speed = '" + *text + "': must be a number, 0 for as fast as possible");
  }
  return speed;
}

}  // namespace

std::string withReceiveBuffer(const std::string& url, long bytes) {
  if (!isUdpm(url) || optionOf(url, "recv_buf_size")) return url;
  return url + (url.find('?') == std::string::npos ? "?" : "&") +
         "recv_buf_size=" + std::to_string(bytes);
}

long receiveBufferOf(const std::string& url) {
  const auto text = optionOf(url, "recv_buf_size");
  return text ? std::strtol(text->c_str(), nullptr, 10) : 0;
}

std::string filePathOf(const std::string& url) {
  const std::string scheme = "file://";
  if (url.rfind(scheme, 0) != 0) return {};
  return url.substr(scheme.size(), url.find('?') == std::string::npos
                                       ? std::string::npos
                                       : url.find('?') - scheme.size());
}

struct Bus::Impl {
  struct Subscription {
    std::regex pattern;
    Inbox* inbox;
    Inbox::Box box;
    Impl* owner;

    /// Called by liblcm's C code: nothing may be thrown through it.
    void onMessage(const lcm::ReceiveBuffer* buffer, const std::string& channel) {
      try {
        const auto* data = static_cast<const std::uint8_t*>(buffer->data);
        deliver(channel, {data, data + buffer->data_size});
      } catch (const std::exception& e) {
        owner->fail(e.what());
      } catch (...) {
        owner->fail("unknown exception while receiving");
      }
    }
    void deliver(const std::string& channel, std::vector<std::uint8_t> bytes) {
      inbox->push(box, {channel, std::move(bytes), std::chrono::steady_clock::now()});
    }
  };

  void fail(const std::string& why) {
    const std::lock_guard lock(mutex);
    if (error.empty()) error = why;
  }

  std::shared_ptr<lcm::LCM> in;
  std::shared_ptr<lcm::LCM> out;
  std::unique_ptr<LogReader> file;
  double speed = 0;
  std::vector<std::unique_ptr<Subscription>> subscriptions;
  std::thread thread;
  std::atomic<bool> stopping = false;
  std::mutex mutex;
  std::string error;
  long asked = 0;
  long granted = 0;

  void receive() {
    while (!stopping) {
      if (in->handleTimeout(kPollMs) < 0) {
        fail("LCM stopped receiving");
        return;
      }
    }
  }

  void replay() {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    std::optional<std::int64_t> first;
    while (!stopping) {
      auto event = file->next();
      if (!event) return;
      if (!first) first = event->utime;
      if (speed > 0) {
        const auto due = start + std::chrono::microseconds(static_cast<std::int64_t>(
                                     static_cast<double>(event->utime - *first) / speed));
        while (!stopping && Clock::now() < due) {
          std::this_thread::sleep_until(
              std::min(due, Clock::now() + std::chrono::milliseconds(kPollMs)));
        }
      }
      for (const auto& s : subscriptions) {
        if (std::regex_match(event->channel, s->pattern)) s->deliver(event->channel, event->data);
      }
    }
  }
};

namespace {

std::shared_ptr<lcm::LCM> openLcm(const std::string& url) {
  auto lcm = std::make_shared<lcm::LCM>(url);
  if (lcm->good()) return lcm;
  const auto report = checkNetwork();
  throw BusError(fmt::format("cannot open LCM at {}\n{}", url, report.text()));
}

}  // namespace

Bus::Bus(const std::string& in_url, const std::string& out_url) : impl_(std::make_unique<Impl>()) {
  if (const auto path = filePathOf(in_url); !path.empty()) {
    try {
      impl_->file = std::make_unique<LogReader>(path);
    } catch (const std::exception& e) {
      throw BusError(e.what());
    }
    impl_->speed = speedOf(in_url);
  } else if (!in_url.empty()) {
    impl_->in = openLcm(withReceiveBuffer(in_url, kDefaultReceiveBuffer));
  }
  if (!out_url.empty()) {
    const bool same = in_url == out_url && impl_->in != nullptr;
    impl_->out = same ? impl_->in : openLcm(withReceiveBuffer(out_url, kDefaultReceiveBuffer));
  }
  const std::string& url = isUdpm(out_url) ? out_url : in_url;
  if (isUdpm(url)) {
    impl_->asked = receiveBufferOf(withReceiveBuffer(url, kDefaultReceiveBuffer));
    const auto report = checkNetwork(impl_->asked);
    impl_->granted = report.granted_buffer;
    if (impl_->granted < impl_->asked) warnings_ = report.text();
  }
}

Bus::~Bus() { stop(); }

void Bus::subscribe(const std::string& channel_regex, Inbox& inbox, Inbox::Box box) {
  impl_->subscriptions.push_back(std::make_unique<Impl::Subscription>(
      Impl::Subscription{std::regex(channel_regex), &inbox, box, impl_.get()}));
  if (!impl_->in) return;
  auto* handler = impl_->subscriptions.back().get();
  auto* subscription = impl_->in->subscribe(channel_regex, &Impl::Subscription::onMessage, handler);
  if (subscription == nullptr) {
    throw BusError(fmt::format("LCM cannot receive (multicast packets do not come back)\n{}",
                               checkNetwork().text()));
  }
  subscription->setQueueCapacity(kLcmQueue);
}

void Bus::start() {
  impl_->thread = std::thread([this] {
    if (impl_->in) impl_->receive();
    if (impl_->file) {
      impl_->replay();
      input_ended_ = true;
    }
  });
}

void Bus::stop() {
  impl_->stopping = true;
  if (!impl_->thread.joinable()) return;
  for (const auto& s : impl_->subscriptions) {
    if (impl_->file) s->inbox->close();  // it may be waiting for room
  }
  impl_->thread.join();
}

std::string Bus::publish(const std::string& channel, const std::vector<std::uint8_t>& bytes) {
  if (!impl_->out) return channel + ": this bus has no out-URL";
  if (impl_->granted > 0 && bytes.size() > largestMessage(impl_->granted)) {
    return tooLargeText(channel, bytes.size(), impl_->asked, impl_->granted);
  }
  if (impl_->out->publish(channel, bytes.data(), static_cast<unsigned>(bytes.size())) != 0) {
    return channel + ": LCM could not send " + std::to_string(bytes.size()) + " bytes";
  }
  return {};
}

std::string Bus::receiveError() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->error;
}

bool Bus::liveInput() const { return impl_->in != nullptr; }

}  // namespace rf
