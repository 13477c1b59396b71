#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace pilotfish::bus {

/// The parts of "udpm://group:port?ttl=N&recv_buf_size=N" that the kernel uses.
struct MulticastUrl {
  std::string group;
  std::uint16_t port = 0;
  int ttl = 0;
  int receive_buffer_bytes = 0;  ///< asked for; 0: the kernel's default
};

/// Nothing for another provider's URL ("memq://"). Throws BusError if a udpm URL is not one that works:
/// liblcm takes a missing port as port 0 and ignores options that it does not know.
std::optional<MulticastUrl> parse_multicast_url(const std::string& url);

/// A non-blocking socket that has joined the group, beside any others on the same port. The caller closes it. Throws
/// BusError with the remedy.
int open_multicast_receiver(const MulticastUrl& url);

/// Checks within 0.2 s whether this host receives its own messages: opens a receiver, sends itself
/// liblcm's own self-test message and waits for it. (liblcm's own receiver would
/// wait 10 s for it.) Returns the size of the receive buffer that the kernel grants to such a socket. Throws
/// BusError with the remedy.
int check_multicast(const MulticastUrl& url);

}  // namespace pilotfish::bus
