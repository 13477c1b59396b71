// A law of one's own, behind the same limits and guards as the fuzzy one. It drives a robot up to a leader that is
// 2 m ahead and 0.3 m to the left, measured without noise.

#include <cmath>
#include <cstdio>
#include <memory>
#include <pilotfish/control/follower.hpp>

using namespace pilotfish;

/// Speed in proportion to the error, turn rate in proportion to the bearing.
class Proportional final : public control::Law {
 public:
  explicit Proportional(double gain_per_s) : gain_per_s_(gain_per_s) {}
  Twist follow(const Observation& seen, const Setpoint& setpoint, double) noexcept override {
    return {gain_per_s_ * (seen.distance_m - setpoint.distance_m),
            2.0 * gain_per_s_ * (seen.bearing_rad - setpoint.bearing_rad)};
  }

 private:
  double gain_per_s_;
};

int main() {
  control::LawDescription law;
  law.name = "proportional";
  law.text = "speed in proportion to the error";
  law.parameters = {{"gain_per_s", 0.8, 0.0, 10.0, "of the distance"}};  // in a file: control.proportional.gain_per_s
  law.make = [](const std::vector<control::LawParameter>& parameters, const control::LimitsConfig&) {
    return std::make_unique<Proportional>(parameters[0].value);
  };

  control::FollowerConfig config;
  control::add_law(config, law);
  control::set_active_law(config, "proportional");
  control::Follower follower(config);

  double x_m = 0.0, y_m = 0.0, heading_rad = 0.0;
  constexpr double kPeriod_s = 1.0 / 30.0;
  for (int k = 0; k <= 240; ++k) {
    Observation seen;
    seen.utime = 1 + static_cast<std::int64_t>(k * kPeriod_s * 1e6);
    seen.distance_m = std::hypot(2.0 - x_m, 0.3 - y_m);
    seen.bearing_rad = std::atan2(0.3 - y_m, 2.0 - x_m) - heading_rad;
    const Twist command = follower.follow(seen, Setpoint{}).command;
    if (k % 30 == 0) std::printf("%d s: d = %.3f m, v = %.3f m/s\n", k / 30, seen.distance_m, command.linear_mps);
    heading_rad += command.angular_radps * kPeriod_s;
    x_m += command.linear_mps * kPeriod_s * std::cos(heading_rad);
    y_m += command.linear_mps * kPeriod_s * std::sin(heading_rad);
  }
}
