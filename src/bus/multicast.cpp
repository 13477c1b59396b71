#include "multicast.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <string_view>
#include <utility>

#include "pilotfish/bus/bus.hpp"

namespace pilotfish::bus {
namespace {

constexpr std::chrono::milliseconds kPatience{200}, kResendAfter{20};

class Socket {
 public:
  Socket() : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) {
    if (descriptor_ < 0) throw BusError(std::string("cannot open a UDP socket: ") + std::strerror(errno));
  }
  ~Socket() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int descriptor() const { return descriptor_; }
  int release() { return std::exchange(descriptor_, -1); }

  template <class Value>
  bool set(int level, int option, const Value& value) const {
    return ::setsockopt(descriptor_, level, option, &value, sizeof value) == 0;
  }

 private:
  int descriptor_;
};

std::string name_of(const MulticastUrl& url) { return url.group + ":" + std::to_string(url.port); }

[[noreturn]] void throw_no_route(const MulticastUrl& url, const std::string& symptom) {
  throw BusError("no way for multicast to " + name_of(url) + " (" + symptom +
                 "). On one host: ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo. "
                 "Between hosts: put the network's interface instead of lo. See also: ip route get " +
                 url.group);
}

sockaddr_in address_of(const MulticastUrl& url) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(url.port);
  ::inet_pton(AF_INET, url.group.c_str(), &address.sin_addr);
  return address;
}

const sockaddr* generic(const sockaddr_in& address) { return reinterpret_cast<const sockaddr*>(&address); }

void join(const Socket& receiver, const MulticastUrl& url) {
  const sockaddr_in address = address_of(url);
  receiver.set(SOL_SOCKET, SO_REUSEADDR, 1);  // allows several programs to receive on one multicast port on Linux
  if (url.receive_buffer_bytes > 0) receiver.set(SOL_SOCKET, SO_RCVBUF, url.receive_buffer_bytes);
  if (::bind(receiver.descriptor(), generic(address), sizeof address) != 0)
    throw BusError("cannot listen on " + name_of(url) + ": " + std::strerror(errno) +
                   ". Another program may hold the port for itself; choose another port in the LCM URL");
  ip_mreq membership{};
  membership.imr_multiaddr = address.sin_addr;
  if (!receiver.set(IPPROTO_IP, IP_ADD_MEMBERSHIP, membership))
    throw_no_route(url, std::string("joining the group: ") + std::strerror(errno));
}

/// liblcm's short message: magic "LC02", sequence number, channel, payload. The payload carries the sender's
/// port, which distinguishes our own message from those of other programs that start at the same time.
std::string self_test_message(const Socket& sender) {
  sockaddr_in own{};
  socklen_t size = sizeof own;
  ::getsockname(sender.descriptor(), reinterpret_cast<sockaddr*>(&own), &size);
  using namespace std::string_literals;
  return "LC02\0\0\0\0LCM_SELF_TEST\0pilotfish "s + std::to_string(::getpid()) + ' ' +
         std::to_string(ntohs(own.sin_port));
}

int number(std::string_view text, int max, const std::string& url, const char* what) {
  int value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0 || value > max)
    throw BusError("the LCM URL " + url + " has no valid " + what + " (0 to " + std::to_string(max) + ")");
  return value;
}

}  // namespace

std::optional<MulticastUrl> parse_multicast_url(const std::string& url) {
  constexpr std::string_view kScheme = "udpm://", kExample = "udpm://239.255.76.67:7667?ttl=0";
  std::string_view rest = url;
  if (rest.substr(0, kScheme.size()) != kScheme) return std::nullopt;
  rest.remove_prefix(kScheme.size());
  const std::size_t question = rest.find('?');
  std::string_view network = rest.substr(0, question);
  if (network.empty()) network = "239.255.76.67:7667";  // as liblcm does
  std::string_view options = question == std::string_view::npos ? std::string_view() : rest.substr(question + 1);

  MulticastUrl parsed;
  const std::size_t colon = network.find(':');
  parsed.group = network.substr(0, colon);
  in_addr group{};
  if (::inet_pton(AF_INET, parsed.group.c_str(), &group) != 1 || !IN_MULTICAST(ntohl(group.s_addr)))
    throw BusError("the LCM URL " + url + " has no multicast group (224.0.0.0 to 239.255.255.255); for example " +
                   std::string(kExample));
  const std::string_view port = colon == std::string_view::npos ? std::string_view() : network.substr(colon + 1);
  parsed.port = static_cast<std::uint16_t>(number(port, 65535, url, "port"));
  if (parsed.port == 0) throw BusError("the LCM URL " + url + " has port 0; for example " + std::string(kExample));

  while (!options.empty()) {
    const std::size_t end = options.find_first_of("&,");
    const std::string_view option = options.substr(0, end);
    options = end == std::string_view::npos ? std::string_view() : options.substr(end + 1);
    const std::size_t equals = option.find('=');
    const std::string_view key = option.substr(0, equals);
    const std::string_view value = equals == std::string_view::npos ? std::string_view() : option.substr(equals + 1);
    if (key == "ttl") {
      parsed.ttl = number(value, 255, url, "ttl");
    } else if (key == "recv_buf_size") {
      parsed.receive_buffer_bytes = number(value, 1 << 30, url, "recv_buf_size");
    } else {
      throw BusError("the LCM URL " + url + " has an unknown option '" + std::string(key) +
                     "'; known: ttl, recv_buf_size");
    }
  }
  return parsed;
}

int open_multicast_receiver(const MulticastUrl& url) {
  Socket receiver;
  join(receiver, url);
  return receiver.release();
}

int check_multicast(const MulticastUrl& url) {
  const sockaddr_in address = address_of(url);
  const Socket receiver, sender;
  join(receiver, url);
  int granted_bytes = 0;
  socklen_t size = sizeof granted_bytes;
  ::getsockopt(receiver.descriptor(), SOL_SOCKET, SO_RCVBUF, &granted_bytes, &size);
  sender.set(IPPROTO_IP, IP_MULTICAST_TTL, 0);  // the test itself stays on this host
  sender.set(IPPROTO_IP, IP_MULTICAST_LOOP, 1);
  sockaddr_in any{};
  any.sin_family = AF_INET;
  if (::bind(sender.descriptor(), generic(any), sizeof any) != 0)  // gives it the port that our message carries
    throw BusError(std::string("no free UDP port on this host: ") + std::strerror(errno));

  using Clock = std::chrono::steady_clock;
  const std::string message = self_test_message(sender);
  const Clock::time_point give_up = Clock::now() + kPatience;
  Clock::time_point resend = Clock::now();
  std::array<char, 256> received{};
  for (Clock::time_point now = resend; now < give_up; now = Clock::now()) {
    if (now >= resend) {
      resend = now + kResendAfter;
      if (::sendto(sender.descriptor(), message.data(), message.size(), 0, generic(address), sizeof address) < 0)
        throw_no_route(url, std::string("sending: ") + std::strerror(errno));
    }
    pollfd waiting{receiver.descriptor(), POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(kResendAfter.count())) <= 0) continue;
    const ssize_t length = ::recv(receiver.descriptor(), received.data(), received.size(), MSG_DONTWAIT);
    if (length > 0 && message == std::string_view(received.data(), static_cast<std::size_t>(length)))
      return granted_bytes;
  }
  throw_no_route(url, "what is sent does not come back; a firewall may swallow it, or the route leads nowhere");
}

}  // namespace pilotfish::bus
