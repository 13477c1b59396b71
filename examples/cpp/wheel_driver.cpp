// A wheel driver that executes a coordinator's commands: wheel_driver ROBOT [LCM_URL]. pilotfish-base does this, and
// more, for differential drives; this is the minimum that is safe.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <optional>
#include <pilotfish/bus/bus.hpp>
#include <pilotfish/core/monotonic.hpp>
#include <pilotfish/core/session_guard.hpp>

namespace {

constexpr std::int64_t kDeadline_us = 85'000;  // without a command; the wheels stand still before 100 ms

void turn_wheels(const pilotfish::Twist& twist) {  // replace this by your motor controller
  std::printf("v = %+.3f m/s, w = %+.3f rad/s\n", twist.linear_mps, twist.angular_radps);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "wheel_driver ROBOT [LCM_URL]\n");
    return 64;
  }
  pilotfish::bus::Bus bus(argc > 2 ? argv[2] : "");
  std::optional<pilotfish::SequenceGuard> guard;  // accepts the first coordinator that sends, and no other
  std::int64_t until_us = 0;
  bool moving = false;
  bus.on_command(argv[1], [&](const pilotfish::bus::CommandReport& report) {
    if (report.simulated || report.session == 0) return;  // not for real wheels
    if (!guard) guard.emplace(report.session);
    if (guard->accept(report.session, report.counter) != pilotfish::SequenceVerdict::accepted) return;
    // Not from now on: it may have waited in the queue, or its measurement may be old (on one computer).
    until_us = std::min(bus.arrival().us + kDeadline_us, report.valid_until_us);
    moving = pilotfish::monotonic_now().us < until_us;  // for zeros there is no validity
    turn_wheels(moving ? report.command : pilotfish::Twist{});
  });
  while (true) {
    bus.handle(5);
    if (moving && until_us <= pilotfish::monotonic_now().us) {
      moving = false;
      turn_wheels({});
    }
  }
} catch (const std::exception& error) {
  turn_wheels({});
  std::fprintf(stderr, "wheel_driver: %s\n", error.what());
  return 1;
}
