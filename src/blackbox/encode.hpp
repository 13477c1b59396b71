#pragma once

#include "pilotfish/blackbox/black_box.hpp"

namespace pilotfish::blackbox {

/// Inputs of one call of the core; what does not belong to its kind stays zero.
struct Call {
  std::int8_t kind = 0;  ///< step_t's KIND_ numbers
  std::int64_t now_us = 0, utime = 0, known_age_us = 0;
  bool coarse_search = false;
  Setpoint setpoint{0.0, 0.0, false};
  Twist twist;
  const RangeScan* scan = nullptr;
  LeadersSeen in_view{};  ///< of a frame: Coordinator::in_view()
};

Bytes encode_frame(std::int64_t sequence, const Call& call, const StepResult& result, const HeldCommand& held);
Bytes encode_call(std::int64_t sequence, const Call& call, bool taken, const HeldCommand& held);
Bytes encode_sent(const HeldCommand& held, MonotonicTime now, Reason missing, const HeldAnswer& sent,
                  std::int64_t session, std::int64_t counter);

struct Instant {
  std::int64_t utime = 0;  ///< wall clock
  MonotonicTime now;
};
Bytes encode_start(const Start& start, const Instant& instant, std::int64_t sequence, const Counters& counters,
                   const CoordinatorMemory& memory);

/// An image_t with a JPEG of quality 95, marked as a copy by the extra `pilotfish_copy`; empty if it cannot be encoded.
Bytes encode_copy(const Frame& frame);
/// An image_t with the pixels themselves; empty if there are none.
Bytes encode_raw(const Frame& frame);

}  // namespace pilotfish::blackbox
