#include "pilotfish/control/fuzzy_velocity_law.hpp"

namespace pilotfish::control {

const std::vector<Parameter<FuzzyVelocityConfig>>& FuzzyVelocityConfig::parameters() {
  using C = FuzzyVelocityConfig;
  static const std::vector<Parameter<C>> table = {
      {"error_scale_m", &C::error_scale_m, 0.01, 20.0, "distance error that is 1 on the universe of e"},
      {"error_change_scale_m", &C::error_change_scale_m, 1e-4, 5.0,
       "change of the error per control period that is 1 on the universe of ec"},
      {"velocity_scale_mps", &C::velocity_scale_mps, 0.01, 5.0, "speed commanded at 1 on the universe of u"},
      {"control_period_s", &C::control_period_s, 1e-3, 1.0, "T of the law, to which ec is referred"},
  };
  return table;
}

VelocityCommand fuzzy_velocity(const fuzzy::Controller& controller, const FuzzyVelocityConfig& config,
                               double distance_setpoint_m, double distance_m, std::optional<double> previous_error_m,
                               double dt_s) {
  VelocityCommand result;
  result.error_m = distance_setpoint_m - distance_m;
  if (previous_error_m && dt_s > 0.0)
    result.error_change_m = (result.error_m - *previous_error_m) * (config.control_period_s / dt_s);
  result.inference = fuzzy::infer(controller, result.error_m / config.error_scale_m,
                                  result.error_change_m / config.error_change_scale_m);
  result.linear_mps = config.velocity_scale_mps * result.inference.output;
  return result;
}

}  // namespace pilotfish::control
