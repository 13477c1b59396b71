#include "pilotfish/control/pbvs_law.hpp"

#include <visp3/core/vpVelocityTwistMatrix.h>
#include <visp3/visual_features/vpFeaturePoint3D.h>
#include <visp3/vs/vpAdaptiveGain.h>
#include <visp3/vs/vpServo.h>

#include <cmath>
#include <limits>

namespace pilotfish::control {

/// ViSP's camera frame has x to the right, y down and z ahead, so a leader at (d, theta) is at X = -d sin(theta),
/// Y = 0, Z = d cos(theta). cRe turns the robot's axes (x ahead, z up) into them; eJe maps (v, w) to a velocity screw.
struct PbvsLaw::Task {
  vpFeaturePoint3D point, wanted;
  vpVelocityTwistMatrix cVe;
  vpMatrix eJe = vpMatrix(6, 2);  // braces would make a row of two numbers
  vpServo servo;

  explicit Task(const PbvsConfig& config) {
    vpRotationMatrix cRe;
    const double turn[3][3] = {{0, -1, 0}, {0, 0, -1}, {1, 0, 0}};
    for (unsigned int row = 0; row < 3; ++row)
      for (unsigned int column = 0; column < 3; ++column) cRe[row][column] = turn[row][column];
    cVe.buildFrom(vpTranslationVector(), cRe);
    eJe = 0.0;
    eJe[0][0] = eJe[5][1] = 1.0;
    point.buildFrom(0.0, 0.0, 1.0);
    wanted.buildFrom(0.0, 0.0, 1.0);
    vpAdaptiveGain gain;
    gain.initStandard(config.gain_at_zero, config.gain_at_infinity, config.slope_at_zero);
    servo.setServo(vpServo::EYEINHAND_L_cVe_eJe);
    servo.setInteractionMatrixType(vpServo::CURRENT, vpServo::PSEUDO_INVERSE);
    servo.setLambda(gain);
    servo.addFeature(point, wanted, vpFeaturePoint3D::selectX() | vpFeaturePoint3D::selectZ());
  }
};

PbvsLaw::PbvsLaw(const PbvsConfig& config, const LimitsConfig&) : task_(std::make_unique<Task>(config)) {}
PbvsLaw::~PbvsLaw() = default;

Twist PbvsLaw::follow(const Observation& seen, const Setpoint& setpoint, double) noexcept {
  try {
    Task& task = *task_;
    task.point.set_XYZ(-seen.distance_m * std::sin(seen.bearing_rad), 0.0,
                       seen.distance_m * std::cos(seen.bearing_rad));
    task.wanted.set_XYZ(-setpoint.distance_m * std::sin(setpoint.bearing_rad), 0.0,
                        setpoint.distance_m * std::cos(setpoint.bearing_rad));
    task.servo.set_cVe(task.cVe);
    task.servo.set_eJe(task.eJe);
    const vpColVector velocity = task.servo.computeControlLaw();
    return {velocity[0], velocity[1]};
  } catch (...) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan};
  }
}

}  // namespace pilotfish::control
