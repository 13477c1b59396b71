#include "inbox.hpp"

#include <utility>

namespace pilotfish::apps {

void Inbox::put(PendingFrame frame) {
  const std::lock_guard lock(mutex_);
  if (newest_) ++overtaken_;
  newest_ = std::move(frame);
  changed_.notify_one();
}

void Inbox::put(const Received& received) {
  const std::lock_guard lock(mutex_);
  if (received_.size() == kMaxReceived) {
    received_.pop_front();
    ++forgotten_;
  }
  received_.push_back(received);
  changed_.notify_one();
}

Inbox::Taken Inbox::take(std::chrono::microseconds timeout) {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [&] { return woken_ || newest_.has_value() || !received_.empty(); });
  woken_ = false;
  Taken taken;
  taken.frame = std::exchange(newest_, std::nullopt);
  taken.received.assign(received_.begin(), received_.end());
  received_.clear();
  return taken;
}

void Inbox::wake() {
  const std::lock_guard lock(mutex_);
  woken_ = true;
  changed_.notify_one();
}

std::int64_t Inbox::overtaken() const {
  const std::lock_guard lock(mutex_);
  return overtaken_;
}

std::int64_t Inbox::forgotten() const {
  const std::lock_guard lock(mutex_);
  return forgotten_;
}

}  // namespace pilotfish::apps
