// SPDX-License-Identifier: BSD-3-Clause
#include "rig.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <utility>

namespace rf {

Rig& Rig::instance() {
  static auto* rig = new Rig();  // never destroyed: its fifo thread runs until the process ends
  return *rig;
}

Rig::Rig() : scene_(std::make_unique<DriverScene>()) {
  if (const char* text = std::getenv("RF_TEST_DRIVER")) command(text);
  if (const char* path = std::getenv("RF_TEST_DRIVER_FIFO")) {
    std::thread([this, path = std::string(path)] { readFifo(path); }).detach();
  }
}

Rig::~Rig() { stopFree(); }

std::string Rig::command(const std::string& text) {
  const std::lock_guard lock(command_mutex_);
  std::string faults;
  std::string line;
  std::string lines = text;
  std::replace(lines.begin(), lines.end(), ';', '\n');
  for (std::istringstream in(lines); std::getline(in, line);) {
    if (line.find_first_not_of(' ') == std::string::npos) continue;
    const std::string fault = obey(line);
    if (!fault.empty()) faults += line + ": " + fault + "\n";
  }
  if (!faults.empty()) fprintf(stderr, "test driver: %s", faults.c_str());
  return faults;
}

std::string Rig::obey(const std::string& line) {
  std::istringstream words(line);
  std::string verb;
  words >> verb;
  if (verb == "frames") {
    int n = 0;
    words >> n;
    for (int i = 0; i < n; ++i) step();
  } else if (verb == "free") {
    double hertz = 0;
    words >> hertz;
    if (!(hertz > 0)) return "needs a rate";
    stopFree();
    free_stop_ = false;
    free_ = std::thread([this, hertz] { runFree(hertz); });
  } else if (verb == "hold") {
    stopFree();
  } else if (verb == "release") {
    const std::lock_guard lock(streams_mutex_);
    for (const RgbdFrame& held : std::exchange(held_colour_, {})) deliver(held, false);
  } else if (verb == "jump") {
    std::int64_t us = 0;
    words >> us;
    const std::lock_guard lock(streams_mutex_);
    offset_us_ += us;
  } else if (verb == "disconnect") {
    setConnected(false);
  } else if (verb == "connect") {
    std::string uri;
    if (words >> uri) {
      const std::lock_guard lock(mutex_);
      uri_ = uri;
    }
    setConnected(true);
  } else if (verb == "refuse") {
    std::string what, state;
    words >> what >> state;
    const std::lock_guard lock(mutex_);
    if (state == "on") refused_.insert(what);
    if (state == "off") refused_.erase(what);
  } else if (verb == "scene") {
    std::string folder;
    words >> folder;
    const std::lock_guard lock(streams_mutex_);
    scene_ = std::make_unique<DriverScene>(folder);
    next_ = 0;
    offset_us_ = 0;
  } else {
    return disturb(verb, words);
  }
  return words.fail() && !words.eof() ? "not understood" : "";
}

std::string Rig::disturb(const std::string& verb, std::istream& words) {
  std::string kind;
  words >> kind;
  if (kind != "depth" && kind != "colour") return "depth or colour?";
  const std::lock_guard lock(streams_mutex_);
  Stream& stream = kind == "depth" ? depth_ : colour_;
  if (verb == "drop") {
    words >> stream.drop;
  } else if (verb == "late") {
    words >> stream.late;
  } else if (verb == "size") {
    words >> stream.width >> stream.height;
  } else {
    return "no such command";
  }
  return words.fail() ? "needs numbers" : "";
}

void Rig::step() {
  const std::lock_guard lock(streams_mutex_);
  if (streams_.empty() || !connected_) return;
  RgbdFrame frame = scene_->frame(next_++, streams_.front()->width(), streams_.front()->height());
  frame.utime += offset_us_;
  frame.colour_utime += offset_us_;
  deliver(frame, true);
  if (colour_.late > 0) {
    --colour_.late;
    held_colour_.push_back(std::move(frame));
  } else {
    deliver(frame, false);
  }
}

void Rig::deliver(const RgbdFrame& frame, bool depth) {
  Stream& stream = depth ? depth_ : colour_;
  if (stream.drop > 0) {
    --stream.drop;
    return;
  }
  for (RigStream* s : streams_)
    if (s->isDepth() == depth) s->deliver(frame, stream.width, stream.height);
}

void Rig::runFree(double hertz) {
  const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(1 / hertz));
  auto due = std::chrono::steady_clock::now();
  std::unique_lock lock(free_mutex_);
  while (!free_stop_) {
    lock.unlock();
    {
      const std::lock_guard streams(streams_mutex_);
      if (scene_->size() > 0 && next_ >= scene_->size()) return;
    }
    step();
    lock.lock();
    due += period;
    free_wake_.wait_until(lock, due, [this] { return free_stop_; });
  }
}

void Rig::stopFree() {
  {
    const std::lock_guard lock(free_mutex_);
    free_stop_ = true;
    free_wake_.notify_all();
  }
  if (free_.joinable()) free_.join();
}

void Rig::readFifo(const std::string& path) {
  std::fstream fifo(path, std::ios::in | std::ios::out);  // both: no end when a writer leaves
  for (std::string line; std::getline(fifo, line);) command(line);
}

void Rig::setConnected(bool connected) {
  std::function<void()> announce;
  {
    const std::lock_guard lock(mutex_);
    if (connected_ == connected) return;
    connected_ = connected;
    announce = announce_;
  }
  // A device that comes is found by the next initialisation, as with drivers that tell of none: the
  // driver of now may be on its way out.
  if (announce && !connected) announce();
}

std::string Rig::uri() const {
  const std::lock_guard lock(mutex_);
  return uri_;
}

bool Rig::refuses(const std::string& what) const {
  const std::lock_guard lock(mutex_);
  return refused_.contains(what);
}

void Rig::attach(std::function<void()> unplugged) {
  const std::lock_guard lock(mutex_);
  announce_ = std::move(unplugged);
}

void Rig::add(RigStream* stream) {
  const std::lock_guard lock(streams_mutex_);
  streams_.push_back(stream);
}

void Rig::remove(RigStream* stream) {
  const std::lock_guard lock(streams_mutex_);
  std::erase(streams_, stream);
}

void Rig::note(const std::string& name, long value) {
  const std::lock_guard lock(mutex_);
  for (auto& [known, old] : notes_) {
    if (known != name) continue;
    old = value;
    return;
  }
  notes_.emplace_back(name, value);
  std::sort(notes_.begin(), notes_.end());
}

std::string Rig::notes() const {
  const std::lock_guard lock(mutex_);
  std::string text;
  for (const auto& [name, value] : notes_)
    text += (text.empty() ? "" : " ") + name + "=" + std::to_string(value);
  return text;
}

}  // namespace rf
