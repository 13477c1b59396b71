#include "frame_feed.hpp"

#include <spdlog/spdlog.h>

#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

namespace pilotfish::apps {
namespace {

class PullFeed final : public FrameFeed {
 public:
  explicit PullFeed(std::function<std::optional<Frame>()> next) : next_(std::move(next)) {}

  std::optional<Arrival> wait(std::chrono::milliseconds) override {
    std::optional<Frame> frame = next_();
    if (!frame) {
      ended_ = true;
      return std::nullopt;
    }
    return Arrival{std::move(*frame), MonotonicClock::now()};
  }
  bool ended() const override { return ended_; }

 private:
  std::function<std::optional<Frame>()> next_;
  bool ended_ = false;
};

/// What the reading thread and the control loop share. Owned by both, so that a thread stuck in a driver can be left
/// behind at the end.
struct Mailbox {
  std::mutex mutex;
  std::condition_variable changed;
  std::optional<Arrival> newest;
  bool stop = false;
};

using OpenSource = std::function<std::unique_ptr<capture::FrameSource>()>;

std::unique_ptr<capture::FrameSource> try_open(const OpenSource& open) {
  try {
    return open();
  } catch (const capture::CaptureError&) {
    return nullptr;  // the next try comes in a second; the status already says that no frame arrives
  }
}

void read_into(const std::shared_ptr<Mailbox>& mailbox, std::unique_ptr<capture::FrameSource> source,
               const OpenSource& open) {
  while (true) {
    std::optional<Frame> frame = source ? source->next() : std::nullopt;
    std::unique_lock lock(mailbox->mutex);
    if (mailbox->stop) return;
    if (frame) {
      mailbox->newest = Arrival{std::move(*frame), MonotonicClock::now()};
      mailbox->changed.notify_all();
      continue;
    }
    if (source && !source->ended()) continue;  // no picture yet
    if (source) spdlog::warn("{}; trying to open it again every second", source->why_ended());
    source.reset();
    if (mailbox->changed.wait_for(lock, std::chrono::seconds(1), [&] { return mailbox->stop; })) return;
    lock.unlock();
    source = try_open(open);
    if (source) spdlog::info("the camera is back: {}", source->describe());
  }
}

class CameraFeed final : public FrameFeed {
 public:
  CameraFeed(std::unique_ptr<capture::FrameSource> first, OpenSource open)
      : mailbox_(std::make_shared<Mailbox>()),
        reader_([mailbox = mailbox_, source = std::move(first), open = std::move(open)]() mutable {
          read_into(mailbox, std::move(source), open);
        }) {}
  CameraFeed(const CameraFeed&) = delete;
  CameraFeed& operator=(const CameraFeed&) = delete;
  ~CameraFeed() override {
    {
      const std::lock_guard lock(mailbox_->mutex);
      mailbox_->stop = true;
    }
    mailbox_->changed.notify_all();
    reader_.detach();  // it may be stuck in the driver; everything it touches is its own or shared
  }

  std::optional<Arrival> wait(std::chrono::milliseconds timeout) override {
    std::unique_lock lock(mailbox_->mutex);
    mailbox_->changed.wait_for(lock, timeout, [&] { return mailbox_->newest.has_value(); });
    return std::exchange(mailbox_->newest, std::nullopt);
  }
  bool ended() const override { return false; }

 private:
  std::shared_ptr<Mailbox> mailbox_;
  std::thread reader_;
};

class BusFeed final : public FrameFeed {
 public:
  BusFeed(bus::Bus& bus, const std::string& channel) : bus_(bus) {
    bus_.on_image(channel, [this](Frame frame) { newest_ = Arrival{std::move(frame), MonotonicClock::now()}; });
  }

  std::optional<Arrival> wait(std::chrono::milliseconds timeout) override {
    bus_.handle(static_cast<int>(timeout.count()));
    return std::exchange(newest_, std::nullopt);
  }
  bool ended() const override { return false; }

 private:
  bus::Bus& bus_;
  std::optional<Arrival> newest_;
};

}  // namespace

std::unique_ptr<FrameFeed> pull_feed(std::function<std::optional<Frame>()> next) {
  return std::make_unique<PullFeed>(std::move(next));
}

std::unique_ptr<FrameFeed> camera_feed(std::unique_ptr<capture::FrameSource> first, OpenSource open) {
  return std::make_unique<CameraFeed>(std::move(first), std::move(open));
}

std::unique_ptr<FrameFeed> bus_feed(bus::Bus& bus, const std::string& channel) {
  return std::make_unique<BusFeed>(bus, channel);
}

}  // namespace pilotfish::apps
