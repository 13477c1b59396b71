#include "service_notify.hpp"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace pilotfish::apps {
namespace {

std::optional<std::int64_t> positive_number(const char* text) {
  if (text == nullptr) return std::nullopt;
  const std::string_view digits(text);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size() || value <= 0) return std::nullopt;
  return value;
}

/// A datagram socket towards the manager; -1 if there is none. sd_notify(3): "/path" or "@abstract".
int connected_to(const std::string& name) {
  sockaddr_un address{};
  if (name.size() < 2 || (name[0] != '/' && name[0] != '@') || name.size() >= sizeof address.sun_path) return -1;
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, name.data(), name.size());
  // An abstract name begins with a zero byte and ends where the address does; a path has a zero byte behind it.
  const std::size_t length = offsetof(sockaddr_un, sun_path) + name.size() + (name[0] == '/' ? 1 : 0);
  if (name[0] == '@') address.sun_path[0] = '\0';
  const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return -1;
  const timeval timeout{1, 0};
  ::setsockopt(descriptor, SOL_SOCKET, SO_SNDTIMEO, &timeout, sizeof timeout);
  if (::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), static_cast<socklen_t>(length)) == 0)
    return descriptor;
  ::close(descriptor);
  return -1;
}

/// A line feed would begin another assignment.
std::string one_line(std::string_view text) {
  std::string line(text.substr(0, 200));
  std::replace(line.begin(), line.end(), '\n', ' ');
  return line;
}

}  // namespace

ServiceEnvironment service_environment(const char* notify_socket, const char* watchdog_usec, const char* watchdog_pid,
                                       long own_pid) {
  ServiceEnvironment environment;
  if (notify_socket != nullptr) environment.socket = notify_socket;
  const std::optional<std::int64_t> period_us = positive_number(watchdog_usec);
  // A child inherits the variables of its parent, which the manager watches; $WATCHDOG_PID distinguishes them.
  const bool for_this_process = watchdog_pid == nullptr || positive_number(watchdog_pid) == own_pid;
  if (period_us && for_this_process) environment.watchdog_period = std::chrono::microseconds(*period_us);
  return environment;
}

ServiceEnvironment service_environment() {
  return service_environment(std::getenv("NOTIFY_SOCKET"), std::getenv("WATCHDOG_USEC"), std::getenv("WATCHDOG_PID"),
                             ::getpid());
}

ServiceNotify::ServiceNotify(const ServiceEnvironment& environment)
    : socket_(connected_to(environment.socket)), watchdog_period_(environment.watchdog_period) {}

ServiceNotify::~ServiceNotify() {
  if (socket_ >= 0) ::close(socket_);
}

void ServiceNotify::ready(std::string_view what) const {
  send("READY=1\nSTATUS=" + one_line(what), Urgency::must_arrive);
}

void ServiceNotify::status(std::string_view what) const { send("STATUS=" + one_line(what)); }

void ServiceNotify::stopping() const { send("STOPPING=1\nSTATUS=stopping"); }

void ServiceNotify::progress(MonotonicTime now) {
  if (!watchdog_period_) return;
  // A quarter, so that a notification that did not fit is repeated twice before the period is over.
  if (last_progress_ && now.us - last_progress_->us < watchdog_period_->count() / 4) return;
  last_progress_ = now;
  send("WATCHDOG=1");
}

void ServiceNotify::send(std::string_view message, Urgency urgency) const {
  if (socket_ < 0) return;
  const int flags = urgency == Urgency::must_arrive ? MSG_NOSIGNAL : MSG_NOSIGNAL | MSG_DONTWAIT;
  (void)::send(socket_, message.data(), message.size(), flags);
}

}  // namespace pilotfish::apps
