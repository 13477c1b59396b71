#include "pilotfish/blackbox/black_box.hpp"

#include <pthread.h>

#include <Eigen/Core>
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <future>
#include <mutex>
#include <pilotfish/step_t.hpp>
#include <thread>
#include <utility>

#include "encode.hpp"
#include "event_queue.hpp"
#include "pilotfish/core/robot_name.hpp"
#include "segment_ring.hpp"

namespace pilotfish::blackbox {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kQueueBytes = 32U << 20;  // ten seconds of JPEG at 30 Hz
constexpr milliseconds kSync{2000};             // a power cut loses at most this much
constexpr milliseconds kIdle{200};
constexpr milliseconds kShutdownTimeout{2000};
/// Every start holds the whole configuration: after gaps, which mean that the disk is slow, not more often than that.
constexpr std::int64_t kStartGap_us = 1'000'000;
constexpr double kLongestGap_us = 9e18;  ///< more is no int64
constexpr std::int64_t kMegabyte = 1'000'000;
constexpr double kHour_us = 3.6e9;

/// -1: no pictures.
std::int64_t gap_between_pictures_us(double rate_hz) {
  if (rate_hz <= 0.0) return -1;
  if (rate_hz >= config::kEveryPicture_hz) return 0;
  return static_cast<std::int64_t>(std::min(1e6 / rate_hz, kLongestGap_us));
}

/// Of the robot's channels, ROBOT1_. Throws ConfigError if it has no name.
std::string prefix_of(const std::string& robot) {
  check_robot_name(robot, "name");
  return channel_word(robot) + "_";
}

/// The caller may own the pixels and change them after this returns.
Frame kept(const Frame& frame) {
  if (frame.pixels_owner || check(frame.image) != Reason::none) return frame;
  // The rows and no more: it may be a corner of something much larger.
  const ImageView& image = frame.image;
  const std::size_t size_bytes = static_cast<std::size_t>(image.stride_bytes) * (image.height - 1) + image.width;
  Frame copy = Frame::from_pixels(frame.utime, image.width, image.height, {image.data, image.data + size_bytes});
  copy.image.stride_bytes = frame.image.stride_bytes;
  return copy;
}

}  // namespace

struct BlackBox::Shared {
  Shared(const config::BlackBoxConfig& config, Start start_of_it)
      : start(std::move(start_of_it)),
        channel_prefix(prefix_of(start.robot)),
        picture_gap_us(gap_between_pictures_us(config.picture_rate_hz)),
        encode_picture(config.raw_pictures ? encode_raw : encode_copy),
        queue(kQueueBytes),
        ring(config.directory, start.robot, wall_utime(),
             {config.total_mb * kMegabyte, config.segment_mb * kMegabyte,
              static_cast<std::int64_t>(config.max_age_h * kHour_us)}) {}

  // From any thread.
  void record(Event&& event) noexcept;

  // By one thread, the core's.
  template <class Encode>
  void record_call(const Coordinator& core, const Encode& encode) noexcept;
  void record_start(const Coordinator& core);

  // The writing thread's.
  void write_all();
  void write(Event& event);

  const Start start;
  const std::string channel_prefix;
  const std::int64_t picture_gap_us;
  Bytes (*const encode_picture)(const Frame&);
  EventQueue queue;
  SegmentRing ring;
  std::int64_t sequence = 0, last_start_us = 0;
  std::atomic<std::int64_t> last_picture_us{0};
  std::atomic<bool> has_gap{false}, is_full{false};  ///< either asks for a start
  bool asked_for_next = false;                       ///< the writing thread's: it has set is_full for this file
  std::atomic<bool> stopping{false};
  std::atomic<std::int64_t> written{0}, dropped{0}, lost{0}, files{0};
  mutable std::mutex trouble_mutex;
  std::string trouble;
  std::promise<void> ended;
  std::thread thread;
};

void BlackBox::Shared::record(Event&& event) noexcept {
  const bool makes_gap = event.kind != Event::Kind::other;
  try {
    if (queue.push(std::move(event))) return;
  } catch (...) {  // no memory
  }
  ++dropped;
  if (makes_gap) has_gap = true;
}

void BlackBox::Shared::record_start(const Coordinator& core) {
  const Instant instant{wall_utime(), monotonic_now()};
  last_start_us = instant.now.us;
  Bytes data = encode_start(start, instant, sequence, {written, dropped, lost, files}, core.memory());
  record({Event::Kind::start, instant.utime, channel_prefix + "BOX", std::move(data), std::nullopt});
}

template <class Encode>
void BlackBox::Shared::record_call(const Coordinator& core, const Encode& encode) noexcept try {
  const std::int64_t number = sequence++;  // in any case: a number that is missing shows the gap
  record({Event::Kind::call, wall_utime(), channel_prefix + "STEP", encode(number), std::nullopt});
  const bool after_gap = has_gap && monotonic_now().us - last_start_us >= kStartGap_us;
  if (!after_gap && !is_full) return;
  has_gap = is_full = false;  // before: the writing thread may want another one by then
  record_start(core);
} catch (...) {  // no memory
  ++dropped;
  has_gap = true;
}

void BlackBox::Shared::write(Event& event) {
  if (event.picture) event.data = encode_picture(*event.picture);
  event.picture.reset();
  if (event.data.empty()) return;
  if (event.kind == Event::Kind::start) {
    if (ring.is_full()) ring.close_segment();
    asked_for_next = false;
  }
  if (ring.write(event)) {
    ++written;
  } else {
    const std::lock_guard<std::mutex> lock(trouble_mutex);
    trouble = std::strerror(errno);
    ++lost;
    if (event.kind != Event::Kind::other) has_gap = true;
  }
  // A file that the ring had to begin by itself has no place to replay from yet.
  const bool begun = files.exchange(ring.files()) != ring.files();
  if (begun && event.kind != Event::Kind::start) has_gap = true;
  if (ring.is_full() && !asked_for_next) is_full = asked_for_next = true;
}

void BlackBox::Shared::write_all() {
  // Signals belong to the program's other threads; that of a file's size limit would end it.
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
  pthread_setname_np(pthread_self(), "black-box");
  Clock::time_point synced = Clock::now();
  for (bool more = true; more;) {
    more = !stopping;  // read before the queue, so that nothing handed over before the end is left in it
    for (Event& event : queue.take(kIdle)) try {
        write(event);
      } catch (...) {  // no memory
        ++lost;
        has_gap = true;
      }
    if (Clock::now() - synced >= kSync) {
      ring.sync();
      synced = Clock::now();
    }
  }
  ring.sync();
  ended.set_value();
}

BlackBox::BlackBox(const config::BlackBoxConfig& config, Start start, const Coordinator& core) {
  check_ranges(config, "black_box");
  if (config.directory.empty()) throw ConfigError("black_box.directory", "is empty");
  shared_ = std::make_shared<Shared>(config, std::move(start));
  shared_->record_start(core);
  sigset_t all, before;  // inherited, so that no signal reaches the new thread before it has blocked them
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  shared_->thread = std::thread([shared = shared_] { shared->write_all(); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

BlackBox::~BlackBox() {
  shared_->stopping = true;
  shared_->queue.wake();
  if (shared_->ended.get_future().wait_for(kShutdownTimeout) == std::future_status::ready) {
    shared_->thread.join();
  } else {
    shared_->thread.detach();  // it waits for a disk that does not answer
  }
}

void BlackBox::frame(const Frame& frame, MonotonicTime now, const StepResult& result,
                     const Coordinator& core) noexcept {
  Call call;
  call.kind = step_t::KIND_FRAME;
  call.now_us = now.us;
  call.utime = frame.utime;
  call.known_age_us = frame.known_age_us;
  call.coarse_search = frame.coarse_search;
  call.in_view = core.in_view();
  shared_->record_call(core, [&](std::int64_t sequence) { return encode_frame(sequence, call, result, core.held()); });
}

void BlackBox::setpoint(const Setpoint& setpoint, bool taken, const Coordinator& core) noexcept {
  Call call;
  call.kind = step_t::KIND_SETPOINT;
  call.setpoint = setpoint;
  shared_->record_call(core, [&](std::int64_t sequence) { return encode_call(sequence, call, taken, core.held()); });
}

void BlackBox::ego_motion(std::int64_t utime, const Twist& twist, bool taken, const Coordinator& core) noexcept {
  Call call;
  call.kind = step_t::KIND_OWN_MOTION;
  call.utime = utime;
  call.twist = twist;
  shared_->record_call(core, [&](std::int64_t sequence) { return encode_call(sequence, call, taken, core.held()); });
}

void BlackBox::leader_intent(std::int64_t utime, const Twist& twist, bool taken, const Coordinator& core) noexcept {
  Call call;
  call.kind = step_t::KIND_LEADER_INTENT;
  call.utime = utime;
  call.twist = twist;
  shared_->record_call(core, [&](std::int64_t sequence) { return encode_call(sequence, call, taken, core.held()); });
}

void BlackBox::ranges(const RangeScan& scan, MonotonicTime now, bool taken, const Coordinator& core) noexcept {
  Call call;
  call.kind = step_t::KIND_RANGES;
  call.now_us = now.us;
  call.utime = scan.utime;
  call.scan = &scan;
  shared_->record_call(core, [&](std::int64_t sequence) { return encode_call(sequence, call, taken, core.held()); });
}

void BlackBox::sent(const HeldCommand& held, MonotonicTime now, Reason missing, const HeldAnswer& sent,
                    std::int64_t session, std::int64_t counter) noexcept try {
  shared_->record({Event::Kind::other, wall_utime(), shared_->channel_prefix + "SENT",
                   encode_sent(held, now, missing, sent, session, counter), std::nullopt});
} catch (...) {  // no memory
  ++shared_->dropped;
}

void BlackBox::message(std::string_view channel, const void* data, std::size_t size_bytes) noexcept try {
  const auto* first = static_cast<const std::uint8_t*>(data);
  shared_->record(
      {Event::Kind::other, wall_utime(), std::string(channel), Bytes(first, first + size_bytes), std::nullopt});
} catch (...) {
  ++shared_->dropped;
}

void BlackBox::picture(const Frame& frame) noexcept try {
  const std::int64_t now_us = monotonic_now().us;
  if (shared_->picture_gap_us < 0 || now_us - shared_->last_picture_us < shared_->picture_gap_us) return;
  shared_->last_picture_us = now_us;
  shared_->record({Event::Kind::other, wall_utime(), shared_->channel_prefix + "IMAGE", {}, kept(frame)});
} catch (...) {
  ++shared_->dropped;
}

Counters BlackBox::counters() const noexcept {
  return {shared_->written, shared_->dropped, shared_->lost, shared_->files};
}

std::string BlackBox::trouble() const {
  const std::lock_guard<std::mutex> lock(shared_->trouble_mutex);
  return shared_->trouble;
}

std::string program_description() {
  const auto number = [](int value) { return std::to_string(value); };
#if defined(__FMA__)
  const std::string fma = " fma";
#else
  const std::string fma;
#endif
#if defined(__x86_64__)
  const std::string processor = "x86_64";
#elif defined(__aarch64__)
  const std::string processor = "aarch64";
#else
  const std::string processor = "other";
#endif
  return "pilotfish " PILOTFISH_VERSION ", " + processor + fma + ", compiler " __VERSION__ ", Eigen " +
         number(EIGEN_WORLD_VERSION) + "." + number(EIGEN_MAJOR_VERSION) + "." + number(EIGEN_MINOR_VERSION);
}

}  // namespace pilotfish::blackbox
