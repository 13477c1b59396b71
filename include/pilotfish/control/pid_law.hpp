#pragma once

#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/control/law.hpp"
#include "pilotfish/control/limits.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/setpoint.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// Gains of two independent PID controllers. The speeds they ask for are limited like those of every law.
struct PidConfig {
  double distance_kp = 1.5;          ///< [1/s]
  double distance_ki = 0.6;          ///< [1/s^2]
  double distance_kd = 0.2;          ///< [1]
  double bearing_kp = 2.5;           ///< [1/s]
  double bearing_ki = 1.0;           ///< [1/s^2]
  double bearing_kd = 0.1;           ///< [1]
  double derivative_filter_s = 0.1;  ///< time constant of the low-pass on the derivatives
  static const std::vector<Parameter<PidConfig>>& parameters();
};

/// A baseline for the fuzzy law: PID on the distance and on the bearing, with a filtered derivative of the measurement
/// and an integral that stands still while the output is saturated (clamping, Astrom and Hagglund, Advanced PID
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
