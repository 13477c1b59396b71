#pragma once

#include <netinet/in.h>

#include <cstdint>
#include <string>
#include <vector>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::bus {

/// One message, encoded in advance, that a crashing process can still send: from a signal handler or
/// std::terminate, where neither allocation nor locks are allowed.
class FinalMessage {
 public:
  /// A whole LCM datagram for a udpm:// URL; with any other provider send() does nothing. Throws BusError if the URL is
  /// wrong or there is no socket.
  FinalMessage(const std::string& url, const std::string& channel, const std::vector<std::uint8_t>& message);
  ~FinalMessage();
  FinalMessage(const FinalMessage&) = delete;
  FinalMessage& operator=(const FinalMessage&) = delete;

  /// Async-signal-safe: sendto(2) and nothing else, three times, because a datagram may be lost.
  void send() const noexcept;

 private:
  int socket_ = -1;
  sockaddr_in address_{};
  std::vector<std::uint8_t> datagram_;
};

}  // namespace pilotfish::bus
PILOTFISH_API_END
