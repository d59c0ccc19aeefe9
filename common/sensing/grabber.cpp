// SPDX-License-Identifier: BSD-3-Clause
#include "sensing/grabber.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "sensing/error.hpp"

namespace rf {
namespace {

constexpr auto kPoll = std::chrono::milliseconds(20);
constexpr std::size_t kMaxNotes = 64;

std::int64_t microseconds(double seconds) { return std::llround(seconds * 1e6); }

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(std::llround(seconds * 1e3));
}

std::string noDevice(const std::string& wanted) {
  return fmt::format(
      "no OpenNI2 device {}: is it in `lsusb`, and in a USB 2 port (the Xtion PRO Live fails in "
      "many "
      "USB 3 ones)? Is the package libopenni2-0 installed, and its udev rule "
      "/lib/udev/rules.d/60-libopenni2-0.rules in force (replug after installing)? "
      "`rf-capture --list` shows what is found; --wait waits for it",
      wanted == "any" ? "is plugged in" : "'" + wanted + "' is plugged in");
}

}  // namespace

Grabber::Grabber(GrabOptions options)
    : options_(std::move(options)),
      queue_(static_cast<std::size_t>(options_.config.queue)),
      wanted_(options_.device) {
  const DeviceConfig& config = options_.config;
  if (const auto& c = options_.calibration;
      c && (c->width != config.width || c->height != config.height)) {
    throw std::invalid_argument(fmt::format(
        "calibration of {}x{}: the device is set to {}x{} (capture.device.width, height)", c->width,
        c->height, config.width, config.height));
  }
  camera_ = options_.calibration;
  if (!open()) {
    if (!options_.wait) throw SensingError(noDevice(wanted_));
    close(noDevice(wanted_));
  }
  thread_ = std::thread([this] { run(); });
}

Grabber::~Grabber() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    wake_.notify_all();
  }
  thread_.join();
}

std::optional<Camera> Grabber::camera() const {
  const std::lock_guard lock(mutex_);
  return camera_;
}

GrabStatus Grabber::status() const {
  const std::lock_guard lock(mutex_);
  GrabStatus out = status_;
  out.dropped = queue_.dropped();
  return out;
}

std::vector<std::string> Grabber::takeNotes() {
  const std::lock_guard lock(mutex_);
  return std::exchange(notes_, {});
}

void Grabber::say(const std::string& note) {
  const std::lock_guard lock(mutex_);
  if (notes_.size() < kMaxNotes) notes_.push_back(note);
}

void Grabber::run() {
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      const auto pause =
          device_ ? std::chrono::milliseconds(0) : milliseconds(options_.config.reconnect_period);
      if (wake_.wait_for(lock, pause, [this] { return stop_; })) break;
    }
    if (device_) {
      grab();
    } else {
      reopen();
    }
  }
  device_.reset();
  session_.reset();
}

bool Grabber::open() {
  // A fresh session: not every driver tells of devices that come later.
  session_ = std::make_unique<OpenniSession>();
  const auto devices = connectedDevices();
  const int chosen = chooseDevice(devices, wanted_);
  if (chosen < 0) return false;
  const DeviceName& name = devices[static_cast<std::size_t>(chosen)];
  device_ = std::make_unique<OpenniDevice>(name, options_.config);
  const Camera camera = options_.calibration ? *options_.calibration : device_->factoryCamera();
  if (!options_.record.empty()) device_->record(recordFile());
  device_->start();
  for (const std::string& warning : device_->warnings()) say(warning);
  pairer_.emplace(microseconds(options_.config.max_pair_gap), 1000000 / options_.config.fps);
  clock_.emplace();
  last_image_ = Clock::now();
  const std::lock_guard lock(mutex_);
  camera_ = camera;
  ++status_.openings;
  status_.connected = true;
  status_.text = fmt::format("{} {} at {}", name.vendor, name.name, name.uri);
  return true;
}

std::string Grabber::recordFile() const {
  // A recording cannot go on after its streams are gone: each opening has a file of its own.
  std::filesystem::path file(options_.record);
  const std::lock_guard lock(mutex_);
  if (status_.openings == 0) return file.string();
  const std::string name =
      fmt::format("{}-{}{}", file.stem().string(), status_.openings + 1, file.extension().string());
  return file.replace_filename(name).string();
}

void Grabber::reopen() {
  try {
    if (open()) {
      say("the device is back: " + status().text);
    } else {
      session_.reset();
    }
  } catch (const SensingError& e) {
    close(e.what());
  }
}

void Grabber::close(const std::string& why) {
  device_.reset();
  session_.reset();
  const std::lock_guard lock(mutex_);
  if (status_.text == why) return;
  status_.connected = false;
  status_.text = why;
  if (notes_.size() < kMaxNotes) notes_.push_back(why);
}

void Grabber::count(std::int64_t GrabStatus::*what) {
  const std::lock_guard lock(mutex_);
  ++(status_.*what);
}

void Grabber::grab() {
  DeviceImage image = device_->read(kPoll);
  const std::int64_t arrival = options_.now();
  if (std::holds_alternative<std::monostate>(image)) {
    closeWhenSilent();
    return;
  }
  last_image_ = Clock::now();
  if (auto* depth = std::get_if<DepthImage>(&image)) {
    count(&GrabStatus::depth_images);
    depth->arrival_us = arrival;
    for (ImagePair& pair : pairer_->add(std::move(*depth))) hand(std::move(pair));
  } else if (auto* colour = std::get_if<ColourImage>(&image)) {
    count(&GrabStatus::colour_images);
    for (ImagePair& pair : pairer_->add(std::move(*colour))) hand(std::move(pair));
  } else {
    drop(std::get<BadImage>(image), arrival);
  }
}

void Grabber::closeWhenSilent() {
  const bool stalled = Clock::now() - last_image_ > milliseconds(options_.config.stall_timeout);
  const bool gone = device_->gone();
  if (!gone && !stalled) return;
  const std::string uri = device_->name().uri;
  for (ImagePair& pair : pairer_->finish()) hand(std::move(pair));
  // Its number on the bus may be another one when it is back, its kind is not.
  if (wanted_ == "any" && uri.find('@') != std::string::npos) wanted_ = uri;
  close(gone
            ? fmt::format("device {} was unplugged; waiting for it", uri)
            : fmt::format("device {}: no image for {} s; opening it anew (a USB 3 port, a hub or a "
                          "weak cable?)",
                          uri, options_.config.stall_timeout));
}

void Grabber::drop(const BadImage& bad, std::int64_t arrival_us) {
  count(&GrabStatus::bad);
  if (std::exchange(last_bad_, bad.problem) != bad.problem) say(bad.problem);
  if (bad.is_depth) handLost(stamp(bad.device_us, arrival_us), bad.problem);
}

std::int64_t Grabber::stamp(std::int64_t device_us, std::int64_t arrival_us) {
  const int jumps = clock_->jumps();
  const std::int64_t mapped =
      clock_->observe(device_us, arrival_us) + microseconds(options_.config.time_offset);
  if (clock_->jumps() != jumps) say("the device's clock or the system's jumped: time mapped anew");
  last_utime_ = std::max(mapped, last_utime_ + 1);
  return last_utime_;
}

void Grabber::hand(ImagePair pair) {
  const std::int64_t utime = stamp(pair.depth.device_us, pair.depth.arrival_us);
  if (!pair.colour) {
    count(&GrabStatus::unpaired);
    handLost(utime, pair.problem);
    return;
  }
  GrabbedFrame out;
  out.utime = utime;
  out.seq = next_seq_++;
  out.gap_us = pair.gap_us;
  out.arrival = Clock::now();
  out.frame = RgbdFrame{utime, utime + pair.gap_us, out.seq, std::move(pair.colour->rgb),
                        std::move(pair.depth.mm)};
  queue_.push(std::move(out));
  const std::lock_guard lock(mutex_);
  ++status_.frames;
  status_.drift_ppm = clock_->drift() * 1e6;
  status_.clock_jumps = clock_->jumps();
}

void Grabber::handLost(std::int64_t utime, const std::string& why) {
  GrabbedFrame out;
  out.utime = utime;
  out.seq = next_seq_++;
  out.problem = why;
  out.arrival = Clock::now();
  queue_.push(std::move(out));
}

}  // namespace rf
