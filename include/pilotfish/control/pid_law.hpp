#pragma once

#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/control/law.hpp"
#include "pilotfish/control/limits.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/setpoint.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// Gains of two independent PID controllers. Their speeds are limited like those of every law.
struct PidConfig {
  PILOTFISH_PARAMETERS(PidConfig);
  PILOTFISH_PARAMETER(double, distance_kp, 1.5, 0.0, 50.0, "speed per metre of distance error [1/s]");
  PILOTFISH_PARAMETER(double, distance_ki, 0.6, 0.0, 50.0, "its integral [1/s2]");
  PILOTFISH_PARAMETER(double, distance_kd, 0.2, 0.0, 50.0, "its derivative");
  PILOTFISH_PARAMETER(double, bearing_kp, 2.5, 0.0, 50.0, "turn rate per radian of bearing error [1/s]");
  PILOTFISH_PARAMETER(double, bearing_ki, 1.0, 0.0, 50.0, "its integral [1/s2]");
  PILOTFISH_PARAMETER(double, bearing_kd, 0.1, 0.0, 50.0, "its derivative");
  PILOTFISH_PARAMETER(double, derivative_filter_s, 0.1, 0.0, 5.0, "time constant of the low-pass on the derivatives");
};

/// A baseline for the fuzzy law: PID on the distance and on the bearing, with a filtered derivative of the measurement
/// and an integral that is held while the output is saturated (clamping, Astrom and Hagglund, Advanced PID
/// Control, 3.5).
class PidLaw final : public Law {
 public:
  /// Within these limits.
  PidLaw(const PidConfig& config, const LimitsConfig& limits) : config_(config), limits_(limits) {}

  /// The wanted twist, not yet limited in acceleration; dt_s since the last call.
  Twist follow(const Observation& observation, const Setpoint& setpoint, double dt_s) noexcept override;
  void restart() noexcept override { distance_ = bearing_ = Axis{}; }

  void remember(CheckpointWriter& archive) const override { archive(distance_, bearing_); }
  void remember(CheckpointReader& archive) override { archive(distance_, bearing_); }  ///< as it was written

 private:
  struct Axis {
    double integral = 0.0;
    double rate = 0.0;
    std::optional<double> last_error;
    template <class Self, class Archive>
    static void remember(Self& self, Archive& archive) {
      archive(self.integral, self.rate, self.last_error);
    }
  };
  double control(Axis& axis, double error, double kp, double ki, double kd, double least, double most,
                 double dt_s) const noexcept;

  PidConfig config_;
  LimitsConfig limits_;
  Axis distance_, bearing_;
};

}  // namespace pilotfish::control
PILOTFISH_API_END
