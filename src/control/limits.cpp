#include "pilotfish/control/limits.hpp"

#include <algorithm>

namespace pilotfish::control {
namespace {

double slew(double wanted, double previous, double max_change) {
  return std::clamp(wanted, previous - max_change, previous + max_change);
}

}  // namespace

Twist limit(const LimitsConfig& config, const Twist& wanted, const Twist& previous, double dt_s) {
  if (!is_finite(wanted)) return Twist{};  // clamping would make full speed of an infinity
  const double dt = dt_s > 0.0 ? dt_s : 0.0;
  const Twist from = is_finite(previous) ? previous : Twist{};
  Twist limited;
  limited.linear_mps = slew(wanted.linear_mps, from.linear_mps, config.max_linear_acceleration_mps2 * dt);
  limited.angular_radps = slew(wanted.angular_radps, from.angular_radps, config.max_angular_acceleration_radps2 * dt);
  // Speed limits last: they hold even if the previous command broke them.
  limited.linear_mps = std::clamp(limited.linear_mps, -config.max_reverse_mps, config.max_linear_mps);
  limited.angular_radps = std::clamp(limited.angular_radps, -config.max_angular_radps, config.max_angular_radps);
  return limited;
}

}  // namespace pilotfish::control
