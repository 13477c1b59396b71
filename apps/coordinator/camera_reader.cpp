#include "camera_reader.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "real_time.hpp"

namespace pilotfish::apps {

namespace {

constexpr std::chrono::milliseconds kOpenAgainEvery{250};

}  // namespace

struct CameraReader::Shared {
  std::unique_ptr<capture::FrameSource> source;
  OpenSource open;
  std::shared_ptr<Inbox> inbox;
  std::mutex mutex;
  std::condition_variable changed;
  bool stop = false;

  bool stopped_within(std::chrono::milliseconds time) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, time, [&] { return stop; });
  }

  void read() {
    become_real_time("the camera", kListeningPriority);
    while (!stopped_within(std::chrono::milliseconds(0))) {
      std::optional<Frame> frame = source ? source->next() : std::nullopt;
      const MonotonicTime at = monotonic_now();
      if (frame) {
        inbox->put(PendingFrame{at, [frame = std::move(*frame)]() -> std::optional<Frame> { return frame; }, nullptr});
        continue;
      }
      if (source && !source->ended()) continue;  // no picture yet
      if (source) spdlog::warn("{}; trying to open it again", source->why_ended());
      source.reset();
      if (stopped_within(kOpenAgainEvery)) return;
      try {
        source = open();
        spdlog::info("the camera is back: {}", source->describe());
      } catch (const capture::CaptureError&) {
        source = nullptr;  // the next try comes; the status already says that no frame arrives
      }
    }
  }
};

CameraReader::CameraReader(std::unique_ptr<capture::FrameSource> first, OpenSource open, std::shared_ptr<Inbox> inbox)
    : shared_(std::make_shared<Shared>()) {
  shared_->source = std::move(first);
  shared_->open = std::move(open);
  shared_->inbox = std::move(inbox);
  thread_ = std::thread([shared = shared_] { shared->read(); });
}

CameraReader::~CameraReader() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->stop = true;
  }
  shared_->changed.notify_all();
  thread_.detach();  // it may be stuck in the driver; everything it touches is its own or shared
}

}  // namespace pilotfish::apps
