#include "bus_listener.hpp"

#include <spdlog/spdlog.h>

#include <cmath>
#include <cstdlib>
#include <utility>

#include "real_time.hpp"

namespace pilotfish::apps {
namespace {

constexpr int kHandle_ms = 50;

/// Stamps from this date on (the year 2000) are taken for a wall clock's, which then gives their age: a recording
/// of any age must not pass for a camera. So are those of the next day. Others are of another clock, of which
/// only the order is used, or of a camera computer whose clock was never set. Which ages are accepted
/// is decided by FrameTimeline, for each frame anew: one frame's stamp is no evidence for another's.
constexpr std::int64_t kFirstDate_utime = 946'684'800'000'000;
constexpr double kNextDay_us = 86'400e6;
/// The same for this host's monotonic clocks, which a program on it may use for stamps. No wall clock is near them.
constexpr double kMonotonicClock_us = 10e6;

std::int64_t known_age_us(std::int64_t utime, MonotonicTime arrival) {
  const std::int64_t now_us = monotonic_now().us, waited_us = now_us - arrival.us;
  const auto age_us = [&](std::int64_t clock_us) {
    return static_cast<double>(clock_us - waited_us) - static_cast<double>(utime);
  };
  for (const std::int64_t clock_us : {unsuspended_now_us(), now_us})
    if (std::abs(age_us(clock_us)) < kMonotonicClock_us) return static_cast<std::int64_t>(age_us(clock_us));
  const double wall_us = age_us(wall_utime());
  return utime >= kFirstDate_utime && wall_us > -kNextDay_us ? static_cast<std::int64_t>(wall_us) : 0;
}

}  // namespace

BusListener::BusListener(const ListenerConfig& config, std::shared_ptr<Inbox> inbox)
    : config_(config),
      inbox_(std::move(inbox)),
      bus_(config.url),
      gate_(config.session, config.stop_distance_m),
      kept_(config.setpoint) {
  if (config_.key) bus_.set_key(*config_.key);
  bus_.on_command(config_.robot, [this](const bus::CommandReport& command) {
    // Our own come back. One that we have not sent yet is from another sender, which has read our session from the bus.
    if (command.session == config_.session && (sender_ == nullptr || command.counter <= sender_->sent())) return;
    rival_ = command.session;
    if (sender_ != nullptr) sender_->rival_command_received(monotonic_now());
  });
  bus_.on_base(config_.robot, [this](const bus::BaseReport& base) {
    if (sender_ != nullptr) sender_->base_report_received(base.session, base.monotonic_us);
  });
  bus_.on_setpoint(config_.robot, [this](const bus::SetpointReport& asked) { hear_setpoint(asked); });
  if (!config_.image_channel.empty())
    bus_.on_encoded_image(config_.image_channel, [this](const bus::EncodedImage& image) {
      const std::int64_t age_us = config_.simulated ? 0 : known_age_us(image.utime, image.arrival);
      inbox_->put(PendingFrame{image.arrival, [this, image, age_us] { return decode(image, age_us); },
                               image.is_jpeg ? image.message : nullptr});
    });
  if (config_.odometry)
    bus_.on_pose(config_.robot, [this](const bus::MotionReport& own) {
      inbox_->put(ReceivedMotion{own.utime, own.twist, false});
    });
  if (config_.ranges)
    bus_.on_ranges(config_.robot, [this](const RangeScan& scan) {
      inbox_->put(ReceivedRanges{std::make_shared<const RangeScan>(scan), bus_.arrival()});
    });
  if (!config_.leader_intent_from.empty())
    bus_.on_motion(config_.leader_intent_from, [this](const bus::MotionReport& leader) {
      inbox_->put(ReceivedMotion{leader.utime, leader.twist, true});
    });
}

BusListener::~BusListener() { stop(); }

std::optional<Frame> BusListener::decode(const bus::EncodedImage& image, std::int64_t age_us) {
  if (image.width != config_.width || image.height != config_.height) {
    // Not decoded. It is passed on without pixels, so that the status shows what is wrong.
    Frame frame;
    frame.utime = image.utime;
    frame.image.width = frame.image.stride_bytes = image.width;
    frame.image.height = image.height;
    return frame;
  }
  std::string_view rejection;
  std::optional<Frame> frame = bus::decode(image, rejection);
  if (frame) {
    frame->known_age_us = age_us;
  } else {
    const std::lock_guard lock(mutex_);
    ++refused_pictures_[std::string(rejection)];
  }
  return frame;
}

void BusListener::hear_setpoint(const bus::SetpointReport& asked) {
  if (sender_ == nullptr) return;
  const SetpointDecision decision = gate_.decide(asked.session, asked.counter, asked.setpoint, kept_);
  switch (decision.verdict) {
    case SetpointVerdict::stopped: sender_->stop_received(); break;
    case SetpointVerdict::accepted: break;
    default: ++refused_setpoints_[std::string(to_string(decision.verdict))]; return;
  }
  kept_ = decision.setpoint;
  inbox_->put(ReceivedSetpoint{kept_, gate_.last_counter(), sender_->stops_received()});
}

std::optional<std::int64_t> BusListener::rival_within(int milliseconds) {
  const MonotonicTime begin = monotonic_now();
  for (std::int64_t left_ms = milliseconds; left_ms > 0 && !rival_;
       left_ms = milliseconds - (monotonic_now().us - begin.us) / 1000)
    bus_.handle(static_cast<int>(left_ms));
  return rival_;
}

void BusListener::start(CommandSender& sender, std::function<void(const std::string&)> failed) {
  sender_ = &sender;
  thread_ = std::thread([this, failed = std::move(failed)] { run(failed); });
}

void BusListener::run(const std::function<void(const std::string&)>& failed) {
  become_real_time("the bus", kListeningPriority);
  try {
    while (!stopping_) {
      bus_.handle(kHandle_ms);
      count_refused();
    }
  } catch (const std::exception& error) {
    failed(error.what());
  }
}

void BusListener::stop() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

void BusListener::count_refused() {
  const std::lock_guard lock(mutex_);
  for (const auto& [name, count] : bus_.rejected()) refused_[name] = count;
  for (const auto& [name, count] : refused_setpoints_) refused_[name] = count;
}

Counters BusListener::refused() const {
  const std::lock_guard lock(mutex_);
  Counters all = refused_;
  for (const auto& [name, count] : refused_pictures_) all[name] += count;
  return all;
}

}  // namespace pilotfish::apps
