#include "tell_setpoints.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <sstream>

#include "pilotfish/core/monotonic.hpp"
#include "play.hpp"
#include "stop_signal.hpp"

namespace pilotfish::apps {
namespace {

constexpr double kResendAfter_s = 0.05;

double monotonic_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What is known of one coordinator, and what it has been told.
struct Told {
  Setpoint setpoint;
  std::int64_t session = 0;        ///< heard; 0: not yet
  std::int64_t last_counter = 0;   ///< that it says it has accepted
  std::int64_t first_counter = 0;  ///< that it was sent in this session; 0: none yet
  std::int64_t counter = 0;        ///< that it was sent last
  double sent_s = 0.0;
  bool shown = false;
  bus::Counters rejected;

  void heard_session(std::int64_t heard) {
    if (heard == 0 || heard == session) return;
    session = heard;
    first_counter = counter = 0;
  }

  void heard_status(const bus::StatusReport& status) {
    heard_session(status.session);
    last_counter = status.setpoint_counter;
    for (const auto& [name, count] : status.rejected) rejected[name] = count;
    shown = first_counter != 0 && status.session == session && last_counter >= first_counter &&
            status.setpoint.distance_m == setpoint.distance_m && status.setpoint.bearing_rad == setpoint.bearing_rad &&
            status.setpoint.run == setpoint.run;
  }

  std::string missing() const {
    if (session == 0) return "has not said its session";
    std::ostringstream text;
    text << "does not show the setpoint it was sent";
    for (const auto& [name, count] : rejected)
      if (name.rfind("setpoint_", 0) == 0) text << ", " << name << " " << count;
    return text.str();
  }
};

using ToldByRobot = std::map<std::string, Told>;

void send_where_due(ToldByRobot& robots, bus::Bus& bus, std::int64_t utime) {
  for (auto& [robot, told] : robots) {
    const double now_s = monotonic_s();
    if (told.session == 0 || told.shown || (told.counter != 0 && now_s - told.sent_s < kResendAfter_s)) continue;
    told.counter = std::max({wall_utime(), told.counter + 1, told.last_counter + 1});
    if (told.first_counter == 0) told.first_counter = told.counter;
    told.sent_s = now_s;
    bus.publish(robot, bus::SetpointReport{utime, told.session, told.counter, told.setpoint});
  }
}

NoAnswer not_shown(const ToldByRobot& robots, double waited_s, const bus::Bus& bus) {
  std::ostringstream text;
  const char* separator = "";
  for (const auto& [robot, told] : robots) {
    if (told.shown) continue;
    text << separator << robot << " " << told.missing();
    separator = "; ";
  }
  text << " (" << waited_s << " s on " << bus.url() << "); is pilotfish-coordinator running with that --name and "
       << "--lcm-url, the source lcm, and the same key?";
  return NoAnswer(text.str());
}

}  // namespace

void tell_setpoints(const sim::Scenario& scenario, bus::Bus& bus, double wait_s) {
  // Shared with the handlers, which the bus keeps for good.
  const auto robots = std::make_shared<ToldByRobot>();
  for (const sim::RobotSpec& robot : scenario.robots) {
    if (robot.follows.empty() || !robot.setpoint) continue;
    (*robots)[robot.name].setpoint = *robot.setpoint;
    bus.on_command(robot.name, [robots, name = robot.name](const bus::CommandReport& report) {
      robots->at(name).heard_session(report.session);
    });
    bus.on_status(robot.name, [robots, name = robot.name](const bus::StatusReport& report) {
      robots->at(name).heard_status(report);
    });
  }
  const auto all_shown = [&] {
    return std::all_of(robots->begin(), robots->end(), [](const auto& entry) { return entry.second.shown; });
  };
  const double asked_s = monotonic_s();
  while (!all_shown() && !stop_requested()) {
    if (monotonic_s() - asked_s > wait_s) throw not_shown(*robots, wait_s, bus);
    send_where_due(*robots, bus, sim::kStartUtime);
    bus.handle(10);
  }
}

}  // namespace pilotfish::apps
