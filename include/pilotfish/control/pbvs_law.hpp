#pragma once

#include <memory>

#include "pilotfish/api.hpp"
#include "pilotfish/control/law.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/setpoint.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// ViSP's adaptive gain, lambda(x) = (zero - infinity) exp(-slope x / (zero - infinity)) + infinity, of the norm x of
/// the error. The defaults are those of ViSP's tutorial.
struct PbvsConfig {
  PILOTFISH_PARAMETERS(PbvsConfig);
  PILOTFISH_PARAMETER(double, gain_at_zero, 2.5, 0.01, 50.0, "gain where the error is zero [1/s]");
  PILOTFISH_PARAMETER(double, gain_at_infinity, 0.4, 0.01, 50.0, "gain where it is great [1/s]");
  PILOTFISH_PARAMETER(double, slope_at_zero, 30.0, 0.0, 1000.0,
                      "how fast the gain falls from the one to the other [1/(m s)]");
};

/// A baseline for the fuzzy law: ViSP's position-based visual servo of a unicycle on the coordinates X and Z of a 3D
/// point, as in ViSP's tutorial for a mobile robot with an AprilTag (mbot-apriltag-pbvs). The point is the leader's
/// base origin, seen by a camera in the coordinator's own origin, so that it works on the same numbers as the other
/// laws. In builds with the component `visp` only.
class PbvsLaw final : public Law {
 public:
  /// Within these limits.
  PbvsLaw(const PbvsConfig& config, const LimitsConfig& limits);
  ~PbvsLaw() override;

  /// The wanted twist, not yet limited. Not finite if ViSP throws, to which the coordinator answers with a stop.
  Twist follow(const Observation& observation, const Setpoint& setpoint, double dt_s) noexcept override;

 private:
  struct Task;
  std::unique_ptr<Task> task_;
};

}  // namespace pilotfish::control
PILOTFISH_API_END
