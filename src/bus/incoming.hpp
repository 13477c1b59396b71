#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pilotfish/core/monotonic.hpp"

namespace pilotfish::bus {

/// A whole message as it came off the wire: nothing in it has been checked yet.
struct WireMessage {
  std::string channel;
  std::shared_ptr<const std::vector<std::uint8_t>> payload;
  MonotonicTime arrival;  ///< when its first byte reached this host
};

/// Counts what was refused, under a name of at most 24 letters; the names are few and fixed.
using Count = std::function<void(std::string_view kind, std::int64_t times)>;

/// What one call of Bus::handle() may take off the wire, so that no flood blocks it. A socket's buffer of 4 MiB
/// holds less than the bytes.
struct Budget {
  int datagrams = 1000;
  std::int64_t bytes = 8 << 20;

  bool used_up() const { return datagrams <= 0 || bytes <= 0; }
  void use(std::size_t datagram_bytes) {
    --datagrams;
    bytes -= static_cast<std::int64_t>(datagram_bytes);
  }
};

/// The source of a Bus's messages: our own receiver for udpm://, liblcm for its other providers.
class Incoming {
 public:
  Incoming() = default;
  virtual ~Incoming() = default;
  Incoming(const Incoming&) = delete;
  Incoming& operator=(const Incoming&) = delete;

  /// From now on next() may return messages of this channel. `large`: they may take more than one datagram.
  /// Throws BusError.
  virtual void subscribe(const std::string& channel, bool large) = 0;
  /// True when something may have come; false after `timeout`, or when a signal came.
  virtual bool wait(std::chrono::milliseconds timeout) = 0;
  /// Nothing: no message is there now, or the budget is used up.
  virtual std::optional<WireMessage> next(Budget& budget) = 0;
};

}  // namespace pilotfish::bus
