#include "pilotfish/bus/final_message.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>

#include "multicast.hpp"
#include "pilotfish/bus/bus.hpp"

namespace pilotfish::bus {

FinalMessage::FinalMessage(const std::string& url, const std::string& channel,
                           const std::vector<std::uint8_t>& message) {
  const auto multicast = parse_multicast_url(url);
  if (!multicast) return;
  socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) throw BusError(std::string("cannot open a UDP socket: ") + std::strerror(errno));
  const int ttl = multicast->ttl, loop = 1;
  ::setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_TTL, &ttl, sizeof ttl);
  ::setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_LOOP, &loop, sizeof loop);
  address_.sin_family = AF_INET;
  address_.sin_port = htons(multicast->port);
  ::inet_pton(AF_INET, multicast->group.c_str(), &address_.sin_addr);
  // liblcm's short message: magic, sequence number (which no receiver uses in a short one), channel, payload.
  using namespace std::string_view_literals;
  constexpr std::string_view kHeader = "LC02\0\0\0\0"sv;
  datagram_.assign(kHeader.begin(), kHeader.end());
  datagram_.insert(datagram_.end(), channel.begin(), channel.end());
  datagram_.push_back(0);
  datagram_.insert(datagram_.end(), message.begin(), message.end());
}

FinalMessage::~FinalMessage() {
  if (socket_ >= 0) ::close(socket_);
}

void FinalMessage::send() const noexcept {
  if (socket_ < 0) return;
  const auto* address = reinterpret_cast<const sockaddr*>(&address_);
  for (int i = 0; i < 3; ++i) ::sendto(socket_, datagram_.data(), datagram_.size(), 0, address, sizeof address_);
}

}  // namespace pilotfish::bus
