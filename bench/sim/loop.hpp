#pragma once

#include <chrono>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "pilotfish/config/files.hpp"
#include "pilotfish/sim/world.hpp"

namespace pilotfish::bench {

using Clock = std::chrono::steady_clock;

/// Processor time of the thread that asks [ns]: what a loop costs, also on a computer that does other things meanwhile.
inline std::int64_t thread_ns() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return now.tv_sec * 1'000'000'000LL + now.tv_nsec;
}

/// Where the processor time of one closed-loop frame went [ns], and how well the robot follows at its exposure.
struct FrameFigures {
  std::int64_t move_ns = 0;           ///< the world's robots drive on to this exposure
  std::int64_t render_ns = 0;         ///< the camera's picture
  std::int64_t see_decide_ns = 0;     ///< from the picture to the command
  bool seen = false;                  ///< the leader was measured
  double distance_error_m = 0.0;      ///< true distance less the setpoint's
  double bearing_error_rad = 0.0;     ///< true bearing less the setpoint's
  double measured_error_m = 0.0;      ///< measured distance less the true one; 0 where not seen
  double measured_bearing_rad = 0.0;  ///< the same of the bearing
  double measured_heading_rad = 0.0;  ///< the same of the heading
};

/// A simulator, vision and a controller, closed: it is played one exposure after the other.
class Loop {
 public:
  explicit Loop(std::string name) : name_(std::move(name)) {}
  virtual ~Loop() = default;
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;

  const std::string& name() const { return name_; }
  virtual FrameFigures play(int frame) = 0;

 private:
  std::string name_;
};

/// The one robot of a scenario that follows another, and what its coordinator is asked.
struct Follower {
  std::string name;
  CoordinatorConfig config;

  explicit Follower(const sim::Scenario& scenario) {
    for (const sim::RobotSpec& robot : scenario.robots) {
      if (robot.follows.empty()) continue;
      name = robot.name;
      config = config::load_coordinator(robot.coordinator_file).coordinator;
      if (robot.setpoint) config.setpoint = *robot.setpoint;
      return;
    }
    throw ConfigError("robots", "none follows another");
  }
};

/// Errors at this exposure; `seen` may be nothing.
inline void judge(const sim::World& world, const Follower& follower, const std::optional<Observation>& seen,
                  FrameFigures& figures) {
  const RelativePose truth = world.true_relative_pose(follower.name);
  figures.distance_error_m = truth.distance_m - follower.config.setpoint.distance_m;
  figures.bearing_error_rad = truth.bearing_rad - follower.config.setpoint.bearing_rad;
  figures.seen = seen.has_value();
  if (!seen) return;
  figures.measured_error_m = seen->distance_m - truth.distance_m;
  figures.measured_bearing_rad = seen->bearing_rad - truth.bearing_rad;
  figures.measured_heading_rad = std::remainder(seen->heading_rad - truth.heading_rad, 6.283185307179586);
}

inline std::int64_t elapsed_ns(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(to - from).count();
}

}  // namespace pilotfish::bench
