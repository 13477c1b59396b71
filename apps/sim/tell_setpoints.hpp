#pragma once

#include "pilotfish/bus/bus.hpp"
#include "pilotfish/sim/scenario.hpp"

namespace pilotfish::apps {

/// Sends every follower's coordinator the setpoint that the scenario has for it, and returns when all of their status
/// messages show it: what is played after that does not depend on when a datagram came. A coordinator's session is in
/// everything it sends; the counters are microseconds of the wall clock, so that a second run rises above the first.
/// Returns early on a stop signal. Throws NoAnswer after wait_s, naming the coordinators without an answer.
void tell_setpoints(const sim::Scenario& scenario, bus::Bus& bus, double wait_s);

}  // namespace pilotfish::apps
