#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/control/measurement_noise.hpp"
#include "pilotfish/control/own_motion_noise.hpp"
#include "pilotfish/core/observation.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/planar_motion.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// How leaders move. Each of the three is a random walk of the velocity and of the turn rate: in a time t they change
/// by about sigma * sqrt(t).
struct LeaderMotionConfig {
  PILOTFISH_PARAMETERS(LeaderMotionConfig);
  PILOTFISH_PARAMETER(double, quiescent_velocity_sigma, 0.0008, 1e-5, 10.0,
                      "quiescent mode: change of the leader's velocity [m/s per sqrt(s)]");
  PILOTFISH_PARAMETER(double, quiescent_turn_sigma, 0.05, 1e-5, 100.0, "change of its turn rate [rad/s per sqrt(s)]");
  PILOTFISH_PARAMETER(double, manoeuvre_velocity_sigma, 0.05, 1e-5, 10.0, "manoeuvre mode: the same");
  PILOTFISH_PARAMETER(double, manoeuvre_turn_sigma, 1.0, 1e-5, 100.0, "manoeuvre mode: the same");
  PILOTFISH_PARAMETER(double, abrupt_velocity_sigma, 1.5, 1e-5, 10.0, "abrupt mode (stops dead, starts): the same");
  PILOTFISH_PARAMETER(double, abrupt_turn_sigma, 3.0, 1e-5, 100.0, "abrupt mode (stops dead, starts): the same");
  PILOTFISH_PARAMETER(double, change_rate_per_s, 0.2, 1e-4, 30.0, "how often a leader passes from one to another");
  PILOTFISH_PARAMETER(double, own_position_sigma, 0.0002, 0.0, 1.0,
                      "error of the own dead reckoning [m per sqrt(s)], if no more is learned");
  PILOTFISH_PARAMETER(double, gate_sigma, 6.0, 3.0, 100.0, "a measurement farther off than this is an outlier");
  PILOTFISH_PARAMETER(int, max_outliers, 3, 1, 30, "this many outliers in a row restart the estimate");
  PILOTFISH_PARAMETER(double, memory_s, 1.0, 0.0, 10.0,
                      "for this time after the last measurement the estimate goes on; then it begins anew");
};

using LeaderVector = Eigen::Matrix<double, 6, 1>;
using LeaderMatrix = Eigen::Matrix<double, 6, 6>;

/// Where the leader is and how it moves, in the odometry frame of EgoMotion: (x, y, vx, vy, heading, turn rate). The
/// velocity is a vector of its own, not speed times heading: so a tag that is mounted a degree off, or a leader
/// that drives backwards, is no special case. The heading is not wrapped at pi.
struct LeaderEstimate {
  LeaderVector mean = LeaderVector::Zero();        ///< m, m/s, rad, rad/s
  LeaderMatrix covariance = LeaderMatrix::Zero();  ///< of the mean
  /// See core/checkpoint.hpp.
  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {
    archive(self.mean, self.covariance);
  }
};

/// The estimate after dt_s on a coordinated turn with random walks of velocity and turn rate.
LeaderEstimate predict_leader(const LeaderEstimate& estimate, double velocity_sigma, double turn_sigma,
                              double position_sigma, double dt_s) noexcept;

/// Estimates the leader's motion by vision alone: three extended Kalman filters that differ in how much process noise
/// they allow the leader, joined by the interacting multiple model method (Blom and Bar-Shalom, IEEE Trans. Automatic
/// Control 33(8), 1988). The quiescent mode alone would be slow to follow a stop of the leader, the abrupt one alone
/// would pass the camera's noise on to the wheels. No allocation, nothing throws.
class LeaderMotionEstimator {
 public:
  /// The result of an update.
  enum class Outcome {
    started,
    updated,
    position_only,  ///< its heading was an outlier: a flat tag can be seen in two poses
    outlier,
    restarted,
    unusable
  };

  /// Without a leader yet.
  explicit LeaderMotionEstimator(const LeaderMotionConfig& config) : config_(config) {}

  /// One measurement, taken when the coordinator was at `own` (in its odometry frame), with its own covariance. A
  /// covariance or a number that is not finite is `unusable` and changes nothing.
  Outcome update(const Observation& observation, const Pose2& own) noexcept;
  void reset() noexcept {  ///< without a leader again; the learned noise stays
    started_ = false;
    noise_.interrupt();
    own_noise_.interrupt();
  }

  bool started() const { return started_; }      ///< there is an estimate
  std::int64_t utime() const { return utime_; }  ///< of the last update
  /// At `utime`, not before the last update. Only if started().
  LeaderEstimate at(std::int64_t utime) const noexcept;
  /// Mode probabilities: quiescent, manoeuvre, abrupt.
  const std::array<double, 3>& probabilities() const { return probability_; }
  /// What the measurements scatter beyond their claimed covariance, as learned so far.
  const MeasurementNoise& noise() const { return noise_; }
  /// Dead-reckoning drift of the robot, as learned so far.
  const OwnMotionNoise& own_noise() const { return own_noise_; }

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.modes_, self.probability_, self.utime_, self.started_, self.outliers_, self.noise_, self.own_noise_);
  }

 private:
  struct Measurement {
    Eigen::Vector3d mean;
    Eigen::Matrix3d covariance;
  };
  void start(const Measurement& measured, std::int64_t utime) noexcept;
  void mix(double dt_s) noexcept;
  double correct(const Measurement& z, double dt_s) noexcept;
  LeaderEstimate predicted(int mode, double dt_s) const noexcept;
  double own_position_sigma() const noexcept;

  LeaderMotionConfig config_;
  std::array<LeaderEstimate, 3> modes_;
  std::array<double, 3> probability_{};
  std::int64_t utime_ = 0;
  bool started_ = false;
  int outliers_ = 0;
  MeasurementNoise noise_;
  OwnMotionNoise own_noise_;
};

/// The leader relative to a pose of the coordinator: the law's input.
struct LeaderMotion {
  /// Of the leader's base origin, and its heading relative to the coordinator's.
  double distance_m = 0.0, bearing_rad = 0.0, heading_rad = 0.0;
  double radial_mps = 0.0;       ///< the leader's own velocity along the line of sight, away from the coordinator
  double tangential_mps = 0.0;   ///< and across it, to the left
  double turn_rate_radps = 0.0;  ///< the leader's own turn rate [rad/s], positive: to the left
  /// Standard deviations of the three.
  double distance_sigma_m = 0.0, radial_sigma_mps = 0.0, tangential_sigma_mps = 0.0;
};
LeaderMotion seen_from(const Pose2& own, const LeaderEstimate& leader) noexcept;

}  // namespace pilotfish::control
PILOTFISH_API_END
