// SPDX-License-Identifier: BSD-3-Clause
// Encoding runs beside grabbing and never holds it up.
#include "device_node.hpp"

#include <condition_variable>
#include <mutex>
#include <thread>

#include "grabber_fixture.hpp"

namespace rf {
namespace {

/// An encoder that is stuck until it is freed.
class StuckEncoder {
 public:
  EncodedFrame operator()(const RgbdFrame& frame) {
    std::unique_lock lock(mutex_);
    entered_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return free_; });
    return encode(frame);
  }
  void awaitEntered() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return entered_; });
  }
  void free() {
    const std::lock_guard lock(mutex_);
    free_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool entered_ = false, free_ = false;
};

TEST_F(GrabberTest, AStuckEncoderNeverHoldsUpGrabbing) {
  constexpr int kShown = 50;
  ServiceOptions buses;
  buses.bulk_in = buses.state_in = "memq://";
  Service service("capture", buses);
  open();
  StuckEncoder encoder;
  DeviceNode node(
      service, *grabber_, [&](const RgbdFrame& frame) { return encoder(frame); }, "OPENNI_FRAME");
  service.start();
  std::atomic<bool> stop{false};
  std::thread publisher([&] {
    while (!stop) node.step();
  });
  show();
  encoder.awaitEntered();
  for (int i = 1; i < kShown; ++i) show();
  EXPECT_TRUE(becomes([&] { return status().frames == kShown; }));
  EXPECT_EQ(service.monitor().outputs(), 0);

  const int published = 1 + options_.config.queue;  // the stuck one and those that waited
  encoder.free();
  EXPECT_TRUE(becomes([&] { return service.monitor().outputs() == published; }));
  EXPECT_TRUE(becomes([&] { return service.monitor().losses() == kShown - published; }));
  EXPECT_EQ(service.monitor().status(0).n_dropped_queue, kShown - published);
  stop = true;
  publisher.join();
  std::printf("grabbed %lld, published %lld, dropped %lld\n",
              static_cast<long long>(status().frames),
              static_cast<long long>(service.monitor().outputs()),
              static_cast<long long>(status().dropped));
}

}  // namespace
}  // namespace rf
