#include "tell_setpoints.hpp"

#include <algorithm>
#include <memory>
#include <sstream>

#include "pace.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "play.hpp"
#include "stop_signal.hpp"

namespace pilotfish::apps {
namespace {

/// The setpoint sent to one coordinator, and what its messages have shown.
struct SentSetpoint {
  Setpoint setpoint;
  std::int64_t session = 0;        ///< received; 0: not yet
  std::int64_t last_counter = 0;   ///< that it reports as accepted
  std::int64_t first_counter = 0;  ///< that it was sent in this session; 0: none yet
  std::int64_t counter = 0;        ///< that it was sent last
  double sent_s = 0.0;
  bool shown = false;
  bus::Counters rejected;

  void on_session(std::int64_t received) {
    if (received == 0 || received == session) return;
    session = received;
    first_counter = counter = 0;
  }

  void on_status(const bus::StatusReport& status) {
    on_session(status.session);
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

using SentByRobot = std::map<std::string, SentSetpoint>;

void send_where_due(SentByRobot& robots, bus::Bus& bus, std::int64_t utime) {
  for (auto& [robot, sent] : robots) {
    const double now_s = monotonic_s();
    if (sent.session == 0 || sent.shown || (sent.counter != 0 && now_s - sent.sent_s < kResendAfter_s)) continue;
    sent.counter = std::max({wall_utime(), sent.counter + 1, sent.last_counter + 1});
    if (sent.first_counter == 0) sent.first_counter = sent.counter;
    sent.sent_s = now_s;
    bus.publish(robot, bus::SetpointReport{utime, sent.session, sent.counter, sent.setpoint});
  }
}

NoAnswer not_shown(const SentByRobot& robots, double waited_s, const bus::Bus& bus) {
  std::ostringstream text;
  const char* separator = "";
  for (const auto& [robot, sent] : robots) {
    if (sent.shown) continue;
    text << separator << robot << " " << sent.missing();
    separator = "; ";
  }
  text << " (" << waited_s << " s on " << bus.url() << "); is pilotfish-coordinator running with that --name and "
       << "--lcm-url, the source lcm, and the same key?";
  return NoAnswer(text.str());
}

}  // namespace

void tell_setpoints(const sim::Scenario& scenario, bus::Bus& bus, double wait_s) {
  // Shared with the handlers, which the bus keeps for good.
  const auto robots = std::make_shared<SentByRobot>();
  for (const sim::RobotSpec& robot : scenario.robots) {
    if (robot.follows.empty() || !robot.setpoint) continue;
    (*robots)[robot.name].setpoint = *robot.setpoint;
    bus.on_command(robot.name, [robots, name = robot.name](const bus::CommandReport& report) {
      robots->at(name).on_session(report.session);
    });
    bus.on_status(robot.name,
                  [robots, name = robot.name](const bus::StatusReport& report) { robots->at(name).on_status(report); });
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
