#include "pilotfish/control/fuzzy_velocity_law.hpp"

#include <cmath>

namespace pilotfish::control {
namespace {

constexpr double kSqrt2 = 1.41421356237309504880;

}  // namespace

const std::vector<Parameter<FuzzyVelocityConfig>>& FuzzyVelocityConfig::parameters() {
  using C = FuzzyVelocityConfig;
  static const std::vector<Parameter<C>> table = {
      {"error_scale_m", &C::error_scale_m, 0.01, 20.0, "distance error that is 1 on the universe of e"},
      {"error_change_scale_m", &C::error_change_scale_m, 1e-4, 5.0,
       "change of the error per control period that is 1 on the universe of ec"},
      {"velocity_scale_mps", &C::velocity_scale_mps, 0.01, 5.0, "speed commanded at 1 on the universe of u"},
      {"control_period_s", &C::control_period_s, 1e-3, 1.0, "T of the law, to which ec is referred"},
      {"input_sigmas", &C::input_sigmas, 0.0, 5.0,
       "width of the inputs, in standard deviations of the measured distance; 0: singletons, as they are"},
  };
  return table;
}

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
