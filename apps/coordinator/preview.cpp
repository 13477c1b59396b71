#include "preview.hpp"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace pilotfish::apps {
namespace {

constexpr int kNice = 10;  ///< whatever drives comes first

/// The smallest whole factor that makes `width` fit.
int shrink_factor(int width, int max_width) { return std::max(1, (width + max_width - 1) / max_width); }

}  // namespace

Preview::Preview(const config::PreviewConfig& config, std::string robot, const std::string& bus_url)
    : config_(config), robot_(std::move(robot)), bus_(bus_url), thread_([this] { work(); }) {}

Preview::~Preview() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  offered_.notify_one();
  thread_.join();
}

void Preview::offer(const Frame& frame) noexcept {
  const MonotonicTime now = monotonic_now();
  if (now < next_ || !frame.pixels_owner) return;
  // The thread has less priority than this one: not to be waited for. A picture that comes just then is not sent.
  const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
  if (!lock) return;
  newest_ = frame;
  next_ = {now.us + static_cast<std::int64_t>(1e6 / config_.rate_hz)};
  offered_.notify_one();
}

void Preview::work() {
  pthread_setname_np(pthread_self(), "preview");
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice);
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    offered_.wait(lock, [this] { return ending_ || newest_; });
    if (ending_) return;
    const Frame frame = *std::exchange(newest_, std::nullopt);
    lock.unlock();
    bus_.publish_preview(robot_, frame, shrink_factor(frame.image.width, config_.max_width_px), config_.jpeg_quality);
    lock.lock();
  }
}

}  // namespace pilotfish::apps
