#include "liblcm_incoming.hpp"

#include <poll.h>

#include <algorithm>
#include <utility>

#include "pilotfish/bus/bus.hpp"

namespace pilotfish::bus {
namespace {

/// Without a stamp a message may count as this much older than it is.
constexpr std::chrono::milliseconds kLook{5};

}  // namespace

void LiblcmIncoming::subscribe(const std::string& channel, bool /*large*/) {
  if (subscribed_.count(channel) > 0) return;
  if (lcm_subscribe(lcm_, channel.c_str(), &LiblcmIncoming::received, this) == nullptr)
    throw BusError("liblcm could not subscribe to " + channel);
  subscribed_.insert(channel);
}

bool LiblcmIncoming::wait(std::chrono::milliseconds timeout) {
  // Without a subscription liblcm has no receiver to wait on; a descriptor of -1 makes poll() wait all the same.
  pollfd waiting{!subscribed_.empty() && !ended_ ? lcm_get_fileno(lcm_) : -1, POLLIN, 0};
  if (stamped_) return ::poll(&waiting, 1, static_cast<int>(timeout.count())) > 0;
  for (;; timeout -= kLook) {
    const Clocks before = read_clocks();
    const int ready = ::poll(&waiting, 1, static_cast<int>(std::min(timeout, kLook).count()));
    if (ready != 0 || timeout <= kLook) return ready > 0;
    empty_ = before;
  }
}

std::optional<WireMessage> LiblcmIncoming::next(Budget& budget) {
  if (budget.used_up()) return std::nullopt;
  while (waiting_.empty() && !subscribed_.empty() && !ended_) {
    const Clocks before = read_clocks();
    pollfd ready{lcm_get_fileno(lcm_), POLLIN, 0};
    if (::poll(&ready, 1, 0) <= 0) {
      empty_ = before;
      return std::nullopt;
    }
    ended_ = lcm_handle_timeout(lcm_, 0) <= 0;
  }
  if (waiting_.empty()) return std::nullopt;
  WireMessage message = std::move(waiting_.front());
  waiting_.pop_front();
  budget.use(message.payload->size());
  return message;
}

/// Called from liblcm's C code, which an exception must not cross.
void LiblcmIncoming::received(const lcm_recv_buf_t* buffer, const char* channel, void* context) noexcept {
  auto& self = *static_cast<LiblcmIncoming*>(context);
  const auto* data = static_cast<const std::uint8_t*>(buffer->data);
  const MonotonicTime arrival =
      self.stamped_ ? arrival_of(buffer->recv_utime, self.empty_, read_clocks()) : self.empty_.monotonic;
  self.waiting_.push_back(
      {channel, std::make_shared<const std::vector<std::uint8_t>>(data, data + buffer->data_size), arrival});
}

}  // namespace pilotfish::bus
