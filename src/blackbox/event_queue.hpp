#pragma once

#include <pthread.h>
#include <semaphore.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotfish/core/checkpoint.hpp"
#include "pilotfish/core/frame.hpp"

namespace pilotfish::blackbox {

/// One event on its way to the disk.
struct Event {
  enum class Kind {
    call,   ///< of the core: if it is lost, the recording has a gap
    start,  ///< box_start_t: a place to replay from
    other
  };
  Kind kind = Kind::other;
  std::int64_t utime = 0;  ///< wall clock when it was handed over
  std::string channel;
  Bytes data;
  std::optional<Frame> picture;  ///< becomes the data of an image_t, once encoded
  std::size_t bytes() const;
};

/// Of a thread that must not wait for one of lower priority that the scheduler has put aside.
class InheritingMutex {
 public:
  InheritingMutex();
  ~InheritingMutex() { pthread_mutex_destroy(&mutex_); }
  InheritingMutex(const InheritingMutex&) = delete;
  InheritingMutex& operator=(const InheritingMutex&) = delete;
  void lock() { pthread_mutex_lock(&mutex_); }
  void unlock() { pthread_mutex_unlock(&mutex_); }

 private:
  pthread_mutex_t mutex_;
};

/// Events from any thread to one, bounded in bytes. The lock is held for moving a few words.
class EventQueue {
 public:
  explicit EventQueue(std::size_t capacity_bytes);
  ~EventQueue() { sem_destroy(&filled_); }
  EventQueue(const EventQueue&) = delete;
  EventQueue& operator=(const EventQueue&) = delete;

  /// False, and the event is gone, if it does not fit. Calls and starts may use it all, others three quarters.
  bool push(Event&& event);
  /// Everything there is, waiting `timeout` at most for the first.
  std::vector<Event> take(std::chrono::milliseconds timeout);
  void wake() { sem_post(&filled_); }

 private:
  std::size_t capacity_bytes_;
  InheritingMutex mutex_;
  std::vector<Event> events_;
  std::size_t bytes_ = 0;
  sem_t filled_;
};

}  // namespace pilotfish::blackbox
