#pragma once

#include <nlohmann/json.hpp>

#include "pilotfish/sim/scenario.hpp"

namespace pilotfish::bench {

/// All robots of a scenario that follow another, each with its rendered camera and its coordinator, on so many threads.
/// One line of figures: {"robots", "frames", "threads", "made_s" (world and coordinators), "elapsed_s", "frame_ns" (of
/// each, by the clock), "capture_ns", "step_ns", "move_ns" (processor time, summed over frames and threads), "pictures"
/// (a hash of all pixels of all pictures in the order of frames and robots), "seen", "rms_distance_error_m" (last
/// quarter, worst robot)}.
nlohmann::json play_crowd(const sim::Scenario& scenario, int frames, int threads);

}  // namespace pilotfish::bench
