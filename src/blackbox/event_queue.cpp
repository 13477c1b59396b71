#include "event_queue.hpp"

#include <ctime>
#include <mutex>
#include <utility>

namespace pilotfish::blackbox {

std::size_t Event::bytes() const {
  return sizeof(Event) + channel.size() + data.size() + (picture ? picture->image.size_bytes : 0);
}

InheritingMutex::InheritingMutex() {
  pthread_mutexattr_t attributes;
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
  pthread_mutex_init(&mutex_, &attributes);
  pthread_mutexattr_destroy(&attributes);
}

EventQueue::EventQueue(std::size_t capacity_bytes) : capacity_bytes_(capacity_bytes) { sem_init(&filled_, 0, 0); }

bool EventQueue::push(Event&& event) {
  const std::size_t bytes = event.bytes();
  const std::size_t limit = event.kind == Event::Kind::other ? capacity_bytes_ / 4 * 3 : capacity_bytes_;
  {
    const std::lock_guard<InheritingMutex> lock(mutex_);
    if (bytes_ + bytes > limit) return false;
    events_.push_back(std::move(event));
    bytes_ += bytes;
  }
  sem_post(&filled_);
  return true;
}

std::vector<Event> EventQueue::take(std::chrono::milliseconds timeout) {
  timespec until{};
  clock_gettime(CLOCK_MONOTONIC, &until);
  const std::int64_t nanoseconds = until.tv_nsec + timeout.count() * 1'000'000;
  until.tv_sec += nanoseconds / 1'000'000'000;
  until.tv_nsec = nanoseconds % 1'000'000'000;
  sem_clockwait(&filled_, CLOCK_MONOTONIC, &until);
  while (sem_trywait(&filled_) == 0) {  // one post for each event, all of which are taken now
  }
  const std::lock_guard<InheritingMutex> lock(mutex_);
  bytes_ = 0;
  return std::exchange(events_, {});
}

}  // namespace pilotfish::blackbox
