#pragma once

#include <lcm/lcm.h>

#include <deque>
#include <set>

#include "arrival.hpp"
#include "incoming.hpp"

namespace pilotfish::bus {

/// Messages of liblcm's other providers: memq://, file://, tcpq://, ...
class LiblcmIncoming final : public Incoming {
 public:
  /// `stamped`: the provider's times of arrival are true (memq). Those of a log are its own, and those of tcpq are
  /// of the reading, not of the arrival: then the last instant at which nothing was there is used.
  LiblcmIncoming(lcm_t* lcm, bool stamped) : lcm_(lcm), stamped_(stamped), empty_(read_clocks()) {}

  void subscribe(const std::string& channel, bool large) override;
  bool wait(std::chrono::milliseconds timeout) override;
  std::optional<WireMessage> next(Budget& budget) override;

 private:
  static void received(const lcm_recv_buf_t* buffer, const char* channel, void* context) noexcept;

  lcm_t* lcm_;
  bool stamped_;
  bool ended_ = false;  ///< liblcm can give no more, as at the end of a log
  std::set<std::string> subscribed_;
  Clocks empty_;
  std::deque<WireMessage> waiting_;
};

}  // namespace pilotfish::bus
