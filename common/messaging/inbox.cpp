// SPDX-License-Identifier: BSD-3-Clause
#include "messaging/inbox.hpp"

#include <stdexcept>
#include <utility>

namespace rf {

Inbox::Box Inbox::addBox(std::size_t capacity, Overflow overflow) {
  if (capacity < 1) throw std::invalid_argument("mailbox capacity 0: must be at least 1");
  const std::lock_guard lock(mutex_);
  boxes_.push_back({capacity, overflow, {}});
  return boxes_.size() - 1;
}

void Inbox::push(Box box, RawMessage message) {
  std::unique_lock lock(mutex_);
  Mailbox& mailbox = boxes_.at(box);
  if (mailbox.overflow == Overflow::kWait) {
    room_.wait(lock, [&] { return closed_ || mailbox.messages.size() < mailbox.capacity; });
  }
  if (closed_) return;
  if (mailbox.messages.size() >= mailbox.capacity) {
    mailbox.messages.pop_front();
    if (mailbox.overflow == Overflow::kDropOldest) ++dropped_;
  }
  mailbox.messages.push_back(std::move(message));
  ++pushed_;
  news_.notify_all();
}

std::optional<RawMessage> Inbox::pop(Box box) {
  const std::lock_guard lock(mutex_);
  Mailbox& mailbox = boxes_.at(box);
  if (mailbox.messages.empty()) return std::nullopt;
  RawMessage message = std::move(mailbox.messages.front());
  mailbox.messages.pop_front();
  room_.notify_all();
  return message;
}

bool Inbox::waitForNews(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  news_.wait_for(lock, timeout, [&] { return closed_ || pushed_ != seen_; });
  const bool news = pushed_ != seen_;
  seen_ = pushed_;
  return news;
}

void Inbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  news_.notify_all();
  room_.notify_all();
}

std::int64_t Inbox::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

std::size_t Inbox::depth() const {
  const std::lock_guard lock(mutex_);
  std::size_t sum = 0;
  for (const Mailbox& box : boxes_) sum += box.messages.size();
  return sum;
}

std::size_t Inbox::capacity() const {
  const std::lock_guard lock(mutex_);
  std::size_t sum = 0;
  for (const Mailbox& box : boxes_) sum += box.capacity;
  return sum;
}

}  // namespace rf
