#pragma once

#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/fuzzy/mamdani.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// Physical meaning of the normalised universes [-1, 1].
struct FuzzyVelocityConfig {
  PILOTFISH_PARAMETERS(FuzzyVelocityConfig);
  PILOTFISH_PARAMETER(double, error_scale_m, 0.8, 0.01, 20.0, "distance error that is 1 on the universe of e");
  PILOTFISH_PARAMETER(double, error_change_scale_m, 0.02, 1e-4, 5.0,
                      "change of the error per control period that is 1 on the universe of ec");
  PILOTFISH_PARAMETER(double, velocity_scale_mps, 0.6, 0.01, 5.0, "speed commanded at 1 on the universe of u");
  PILOTFISH_PARAMETER(double, control_period_s, 1.0 / 30.0, 1e-3, 1.0, "T of the law, to which ec is referred");
  /// Of the fuzzified inputs A', B' of eq. (6).
  PILOTFISH_PARAMETER(
      double, input_sigmas, 0.0, 0.0, 5.0,
      "width of the inputs, in standard deviations of the measured distance; 0: singletons, as they are");
};

/// One evaluation with its intermediate results, for the status message and for inspection.
struct VelocityCommand {
  double linear_mps = 0.0;      ///< forward speed commanded by the law [m/s]
  double error_m = 0.0;         ///< e(t) = d_p - d(t); positive: too close
  double error_change_m = 0.0;  ///< ec(t), referred to one control period
  fuzzy::Inference inference;   ///< output u* in [-1, 1] and the strengths of the 56 rules
};

/// The paper's law. e(t) = d_p - d(t), ec(t) = e(t) - e(t-1) per control period T. Frames do not come exactly every T,
/// so ec is taken as the error's rate over the REAL time between two measurements, times T; at the nominal rate this is
/// the paper's difference. Without a previous measurement ec = 0.
///
/// With input_sigmas = k > 0 the inputs have the width of their uncertainty: A' is a Gaussian around e of sigma k
/// sigma_d, and B' one around ec of k sqrt(2) sigma_d T/dt, the sigma of the difference of two independent distances.
/// distance_sigma_m: of distance_m, from its covariance; taken as 0 if it is not finite.
VelocityCommand fuzzy_velocity(const fuzzy::Controller& controller, const FuzzyVelocityConfig& config,
                               double distance_setpoint_m, double distance_m, std::optional<double> previous_error_m,
                               double dt_s, double distance_sigma_m = 0.0);

}  // namespace pilotfish::control
PILOTFISH_API_END
