#pragma once

#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "pilotfish/core/status.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// What holds at some instant between two frames.
struct HeldAnswer {
  Status status = Status::searching;  ///< what the coordinator is doing
  Reason reason = Reason::none;       ///< why
  Twist command;                      ///< zero unless it is fresh
};

/// A command that expires by itself: the one of the last measurement, until that is max_age old. A value, so that the
/// sender of commands can use a copy without waiting for the vision.
struct HeldCommand {
  std::int64_t utime = 0;  ///< of the last frame that was in order [us]
  Twist command;           ///< zero unless something is held
  /// Both inclusive; the measurement's arrival, and its exposure plus max_age.
  MonotonicTime from, until;   ///< both inclusive; the measurement's arrival, and its exposure plus max_age
  bool holding = false;        ///< false: the wheels rest, whatever the time
  bool run = true;             ///< the setpoint's
  bool ever_measured = false;  ///< distinguishes lost from searching
  bool turning = false;        ///< the command is a turn in search of the leader, which is lost

  /// The last command while `now` is in [from, until], zeros otherwise; `reason` is what was missing. A clock that
  /// went backward, and a measurement in the future, move nothing.
  HeldAnswer at(MonotonicTime now, Reason reason) const noexcept;
  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.utime, self.command, self.from, self.until, self.holding, self.run, self.ever_measured, self.turning);
  }
  /// Whether the command holds at `now`.
  bool fresh_at(MonotonicTime now) const noexcept { return run && holding && from <= now && now <= until; }
};

}  // namespace pilotfish
PILOTFISH_API_END
