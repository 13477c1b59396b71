#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "pilotfish/api.hpp"
#include "pilotfish/base/diff_drive.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::base {

// The text on the line to the motor controller; docs/base-serial-protocol.md describes it for implementers of
// the controller. One line is
//
//   $TYPE,field,...*HH<CR><LF>       HH: CRC-8 (polynomial 0x07, start 0) of what is between $ and *, two hex digits
//
// A $ always begins a new line, whether the one before has ended or not, so that a truncated line loses only itself.

/// Longest line that either side sends or accepts, from $ to the checksum.
inline constexpr std::size_t kMaxLine = 80;
/// Set-points are whole milliradians per second; more than this is never sent.
inline constexpr std::int32_t kMaxWheel_mradps = 1'000'000;

std::uint8_t crc8(std::string_view text) noexcept;

/// A line ready to be written: "$PFW,<sequence>,<left>,<right>*HH\r\n", speeds in mrad/s, positive: forwards.
class SetPointLine {
 public:
  SetPointLine(std::uint16_t sequence, const WheelSpeeds& speeds) noexcept;  ///< what is not finite is sent as zero
  std::string_view text() const noexcept { return {text_.data(), size_}; }   ///< with its end; valid while this lives

 private:
  std::array<char, kMaxLine + 8> text_{};
  std::size_t size_ = 0;
};

/// Bits of ControllerLine::faults.
enum Fault : std::uint16_t {
  kFaultWatchdog = 1,     ///< no good line for 100 ms, wheels set to zero by the controller: not a fault of the motors
  kFaultMotor = 2,        ///< a motor driver reports an error
  kFaultOvercurrent = 4,  ///< a motor draws too much
  kFaultEncoder = 8,      ///< an encoder does not count
  kFaultSupply = 16,      ///< the supply is too low
  kFaultEmergencyStop = 32,  ///< the emergency stop is pressed
};
/// The most important one as a text. Empty if there is none.
std::string_view first_fault(std::uint16_t faults) noexcept;

/// "$PFE,<sequence>,<ms>,<left>,<right>,<faults>*HH": the controller's report on the wheels.
struct ControllerLine {
  std::uint16_t sequence = 0;  ///< of the last good set-point line
  EncoderReading encoders;     ///< the wheels' counters
  std::uint16_t faults = 0;    ///< bits: 1 watchdog, 2 motor, 4 overcurrent, 8 encoder, 16 supply, 32 emergency stop
};

/// Bytes in, lines out. Never relies on a length, never allocates.
class ControllerParser {
 public:
  /// Refused lines, by reason.
  struct Rejected {
    std::int64_t checksum = 0;   ///< no or a wrong checksum
    std::int64_t malformed = 0;  ///< a right checksum, but not a line of this protocol
    std::int64_t too_long = 0;   ///< longer than the longest line
    std::int64_t cut_short = 0;  ///< a new line began before the end
  };

  /// One byte; the line that it completes.
  std::optional<ControllerLine> feed(char byte) noexcept;
  /// Discards a partly received line (the port was reopened).
  void reset() noexcept;
  const Rejected& rejected() const noexcept { return rejected_; }  ///< since the start

 private:
  std::optional<ControllerLine> complete() noexcept;

  std::array<char, kMaxLine> line_{};
  std::size_t size_ = 0;
  bool inside_ = false;  ///< a $ has been received, and not yet its end
  Rejected rejected_;
};

}  // namespace pilotfish::base
PILOTFISH_API_END
