#pragma once

#include <vector>

#include "arrival.hpp"
#include "incoming.hpp"
#include "multicast.hpp"
#include "reassembly.hpp"

namespace pilotfish::bus {

/// The receiving half of liblcm's udpm provider, checked: one non-blocking socket of which every datagram goes through
/// Reassembly. No thread: what comes between two calls waits in the kernel, under the kernel's time stamp.
class UdpmReceiver final : public Incoming {
 public:
  /// Counts beside Reassembly's kinds: receive_buffer_full (datagrams that the kernel had to drop), datagram_foreign
  /// (from another host although ttl=0 says that the bus is this host alone), receive_failed.
  UdpmReceiver(const MulticastUrl& url, const Count& count);
  ~UdpmReceiver() override;

  void subscribe(const std::string& channel, bool large) override;
  bool wait(std::chrono::milliseconds timeout) override;
  std::optional<WireMessage> next(Budget& budget) override;

 private:
  void open();
  MonotonicTime arrival_now(std::optional<std::int64_t> stamp_wall_us, const Clocks& before, const Clocks& now);
  bool is_foreign(std::uint32_t address, MonotonicTime now);

  MulticastUrl url_;
  Count count_;
  Reassembly reassembly_;
  int socket_ = -1;  ///< from the first subscription on: a publisher alone needs none
  bool takes_fragments_ = false;
  std::uint32_t kernel_drops_ = 0;
  Clocks empty_;  ///< what waits now came after this
  std::vector<std::uint8_t> datagram_;
  std::vector<std::uint32_t> own_addresses_;
  MonotonicTime own_addresses_read_;
};

}  // namespace pilotfish::bus
