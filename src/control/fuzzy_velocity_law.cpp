#include "pilotfish/control/fuzzy_velocity_law.hpp"

#include <cmath>

namespace pilotfish::control {
namespace {

constexpr double kSqrt2 = 1.41421356237309504880;

}  // namespace

VelocityCommand fuzzy_velocity(const fuzzy::Controller& controller, const FuzzyVelocityConfig& config,
                               double distance_setpoint_m, double distance_m, std::optional<double> previous_error_m,
                               double dt_s, double distance_sigma_m) {
  VelocityCommand result;
  result.error_m = distance_setpoint_m - distance_m;
  fuzzy::InputWidths widths;
  widths.shape = fuzzy::WidthShape::gaussian;
  const double width_m = std::isfinite(distance_sigma_m) ? config.input_sigmas * distance_sigma_m : 0.0;
  widths.error = width_m / config.error_scale_m;
  if (previous_error_m && dt_s > 0.0) {
    const double periods = dt_s / config.control_period_s;
    result.error_change_m = (result.error_m - *previous_error_m) / periods;
    widths.error_change = kSqrt2 * width_m / periods / config.error_change_scale_m;
  }
  result.inference = fuzzy::infer(controller, result.error_m / config.error_scale_m,
                                  result.error_change_m / config.error_change_scale_m, widths);
  result.linear_mps = config.velocity_scale_mps * result.inference.output;
  return result;
}

}  // namespace pilotfish::control
