#include "pilotfish/control/limits.hpp"

#include <algorithm>

namespace pilotfish::control {
namespace {

double slew(double wanted, double previous, double max_change) {
  return std::clamp(wanted, previous - max_change, previous + max_change);
}

}  // namespace

Twist limit(const LimitsConfig& config, const Twist& wanted, const Twist& previous, double dt_s) {
  const double dt = std::max(dt_s, 0.0);
  Twist limited;
  limited.linear_mps = slew(wanted.linear_mps, previous.linear_mps, config.max_linear_acceleration_mps2 * dt);
  limited.angular_radps =
      slew(wanted.angular_radps, previous.angular_radps, config.max_angular_acceleration_radps2 * dt);
  // Speed limits last: they hold even if the previous command broke them.
  limited.linear_mps = std::clamp(limited.linear_mps, -config.max_reverse_mps, config.max_linear_mps);
  limited.angular_radps = std::clamp(limited.angular_radps, -config.max_angular_radps, config.max_angular_radps);
  return limited;
}

}  // namespace pilotfish::control
