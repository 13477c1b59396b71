#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/control/ego_motion.hpp"
#include "pilotfish/control/leader_rhythm.hpp"
#include "pilotfish/control/limits.hpp"
#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/core/planar_motion.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// The delays of a drive, and how well they are known.
struct DriveEstimate {
  double latency_s = 0.0;              ///< from the exposure to the moment the command for it reaches the wheels
  double actuator_lag_s = 0.0;         ///< time constant of the wheels' speed control
  double latency_sigma_s = 0.0;        ///< standard deviation of its identification
  double actuator_lag_sigma_s = 0.0;   ///< the same
  bool differs_from_settings = false;  ///< the evidence against the configured delays is strong: these are used instead
};

/// Identifies the drive's latency and lag from the own commands and from what is seen, while driving.
///
/// In the odometry frame the leader's track is smooth if the own motion is right. If it is wrong by a delay dL, each
/// change dv of the own speed leaves a step of dv dL in it, which a third difference detects. So for a grid of
/// latencies and lags the own path is integrated from the commands, the leader's positions z_i seen from it at four
/// times some kSpacing_s apart are taken, and their normalised third divided difference (see MeasurementNoise)
///
///   r = sum w_i z_i / sqrt(sum w_i^2)
///
/// is zero but for noise. Unless the leader itself swings: then the robot behind it swings alike, and a wrong delay can
/// cancel the swing. What is learned in a closed loop is right only if the model of what disturbs it is rich enough to
/// contain the truth (Ljung, System Identification, 2nd ed., section 13.4). So each hypothesis may explain r by a
/// rhythm of the leader, from r' and r'', the differences one and two spacings earlier:
///
///   e = r - f r' - g r'',
///
/// f and g by least squares over the last seconds, this one included (LeaderRhythm): what a rhythm could explain is no
/// evidence. A sine of any frequency w, amplitude and direction has f = 2 cos(w kSpacing_s), g = -1 and leaves e = 0
/// under every hypothesis; a change of the own speed is foretold by none. e adds -rho(e^2 / s^2) / 2 to the logarithm
/// of the hypothesis' probability. s^2 is the median of e^2 under the best hypothesis, so nothing needs to be known of
/// the camera; rho(x) = x / (1 + x / 9) (Geman and McClure, 1985) bounds what a leader that stops dead can say about
/// the own wheels. Consecutive differences overlap, so a frame counts as dt / (1.5 kSpacing_s) of one.
///
/// A leader with two rhythms leaves e other than zero under the true delays, too, and evidence for wrong ones then
/// grows without limit however slightly they are better. So evidence is not enough: over the last seconds the delays in
/// use must also have cost kTimes what the best ones have. What replaces them moves no further than half a place of the
/// grid from where that was so.
///
/// The path with latency L is the one without, L earlier: so one path for each lag is enough. The estimate is the
/// vertex of the parabola through the best hypothesis and its neighbours, its covariance the inverse of the curvature.
/// A robot that does not change its speed adds the same to all hypotheses, and nothing changes. A value; no allocation,
/// nothing throws.
class DriveIdentifier {
 public:
  /// The prior is around what is configured, broadly.
  DriveIdentifier(const DriveModelConfig& configured, const LimitsConfig& limits);

  /// The command for the picture exposed at utime [us], or that it is zero from a time on that a command for a picture
  /// exposed at utime would have had. By time.
  void command(const Twist& twist, std::int64_t utime) noexcept;
  /// The leader's place in the base frame, as seen in the picture exposed at utime [us].
  void observe(std::int64_t utime, double distance_m, double bearing_rad) noexcept;
  /// The leader may be another one now; what is known of the drive stays.
  void interrupt() noexcept { seen_.clear(); }
  /// Times from now on are unrelated to those before; what is known of the drive stays.
  void restart_on_new_clock() noexcept;

  const DriveEstimate& estimate() const { return estimate_; }  ///< as of the last observe()

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.started_, self.present_utime_, self.node_utime_, self.nodes_made_, self.set_value_, self.acting_,
            self.pending_, self.present_, self.nodes_, self.seen_, self.squares_, self.rhythms_, self.log_probability_,
            self.cost_, self.reference_latency_s_, self.reference_lag_s_, self.estimate_.latency_s,
            self.estimate_.actuator_lag_s, self.estimate_.latency_sigma_s, self.estimate_.actuator_lag_sigma_s,
            self.estimate_.differs_from_settings);
  }

  static constexpr std::size_t kLatencies = 16, kLags = 9;                   ///< of the grid
  static constexpr double kFirstLatency_s = 0.01, kLatencyStep_s = 0.02;     ///< 10 to 310 ms
  static constexpr double kLagScale_s = 0.03, kLagRatio = 0.39;              ///< 0 to 650 ms: scale (e^(ratio j) - 1)
  static constexpr double kSpacing_s = 4.0 / 30.0;                           ///< of a difference's four times
  static constexpr double kNode_s = 0.01;                                    ///< of the stored paths
  static constexpr double kPriorLatencySigma_s = 0.1, kPriorLagSigma = 1.0;  ///< the lag's is of ln(lag + scale)
  static constexpr double kStrong = 3.0;                                     ///< evidence: e^3 times as probable
  static constexpr double kTimes = 4.0;  ///< and that much better at explaining what was seen of late
  static constexpr double kSure_latency_s = 0.02, kSure_lag = 0.3;  ///< standard deviations; the lag's is relative

 private:
  struct Command {
    Twist twist;
    std::int64_t utime = 0;
  };
  struct Place {  ///< a pose on a path; the direction as cosine and sine
    double x_m = 0.0, y_m = 0.0, cosine = 1.0, sine = 0.0;
  };
  struct Wheels {  ///< of one lag
    Pose2 pose;
    Twist twist;
  };
  struct Seen {
    std::int64_t utime = 0;
    double forward_m = 0.0, left_m = 0.0;
  };
  static constexpr std::size_t kNodes = 128;  // 5 kSpacing_s with slack, the longest latency, and one to interpolate
  static constexpr std::size_t kSquares = 30;
  using Row = std::array<Place, kLags>;
  static constexpr std::size_t kPictures = 6;  // of r, r' and r''
  using Pictures = std::array<Seen, kPictures>;
  template <class T>
  using Grid = std::array<T, kLatencies * kLags>;

  void advance_to(std::int64_t utime) noexcept;
  void drive_for(double duration_s) noexcept;
  void store_node() noexcept;
  bool pick(Pictures& pictures) const noexcept;
  void weigh(const Pictures& pictures, double since_last_s) noexcept;
  void update_estimate() noexcept;
  void forget_sigmas() noexcept;
  double& log_probability(std::size_t latency, std::size_t lag) noexcept {
    return log_probability_[latency * kLags + lag];
  }

  DriveModelConfig configured_;
  LimitsConfig limits_;
  bool started_ = false;
  std::int64_t present_utime_ = 0, node_utime_ = 0;  ///< of the paths' end, and of the last node
  std::uint64_t nodes_made_ = 0;                     ///< nodes_ is a ring
  Twist set_value_, acting_;                         ///< the same for all lags
  BoundedVector<Command, 16> pending_;
  std::array<Wheels, kLags> present_{};
  std::array<Row, kNodes> nodes_{};
  BoundedVector<Seen, 32> seen_;             ///< by time
  BoundedVector<double, kSquares> squares_;  ///< e^2 of the best hypothesis [m^2]
  Grid<LeaderRhythm> rhythms_{};
  Grid<double> log_probability_{};
  Grid<double> cost_{};                                       ///< of each hypothesis, of late
  double reference_latency_s_ = 0.0, reference_lag_s_ = 0.0;  ///< what was in use when it was last replaced
  DriveEstimate estimate_;
};

}  // namespace pilotfish::control
PILOTFISH_API_END
