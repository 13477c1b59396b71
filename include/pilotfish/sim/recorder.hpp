#pragma once

#include <cstdint>
#include <ostream>
#include <string>

#include "pilotfish/api.hpp"
#include "pilotfish/sim/world.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// The answer to one exposure, as recorded.
struct Answer {
  Twist command;          ///< the answer to this exposure; if there is none, the command in effect then
  std::string status;     ///< its coordinator's status; empty before the first answer
  bool delivered = true;  ///< false: the camera dropped this frame
};

/// One row per following robot and exposure, with the truth at the exposure. Numbers are written so that
/// reading them back gives the same bits. std::out_of_range, and nothing is written, for a robot that follows no other.
void write_recording_header(std::ostream& csv);
void write_recording_row(std::ostream& csv, const World& world, const std::string& robot, const Answer& answer);

}  // namespace pilotfish::sim
PILOTFISH_API_END
