#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/core/bounded_vector.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// One measurement of the leader, in the odometry frame: x [m], y [m], heading [rad].
struct LeaderFix {
  std::int64_t utime = 0;                                    ///< exposure [us]
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();            ///< x, y, heading
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< as claimed by the source of the measurement
  double line_of_sight_rad = 0.0;                            ///< direction from the camera's robot to the leader

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.utime, self.mean, self.covariance, self.line_of_sight_rad);
  }
};

/// How much more the measurements scatter than their covariance claims: what no picture shows, such as a camera that
/// vibrates, rolling shutter or wheels that step. Learned from the measurements alone, nothing to set.
///
/// Whatever moves smoothly has small third differences; noise that is new in every frame has large ones. Of four
/// measurements z_i at times t_i the third divided difference is, with weights
///
///   w_i = 1 / prod_{j != i} (t_i - t_j),     r = sum w_i z_i / sqrt(sum w_i^2),
///
/// zero for any motion of constant acceleration, and of white noise with variance s^2 it has the variance s^2, whatever
/// the times are. The median of r^2 over some 60 frames, over 0.4549 (the median of chi-square with one degree of
/// freedom), is an estimate of s^2 that a leader which stops dead, or a flipped heading, disturbs in a few of its
/// samples only. What the claimed covariance explains is subtracted, twice, so that nothing is added to measurements
/// that are as exact as they say. Kept for the line of sight, across it, and the heading. A value; no allocation,
/// nothing throws.
class MeasurementNoise {
 public:
  /// The next measurement; one that is not newer than the last, or comes after a gap, begins anew with the differences.
  void add(const LeaderFix& fix) noexcept;
  /// What to add to a claimed covariance of (x, y, heading), with the leader in that direction.
  Eigen::Matrix3d excess_covariance(double line_of_sight_rad) const noexcept;
  /// Standard deviations along the line of sight [m], across it [m], of the heading [rad]; zeros until enough is known.
  Eigen::Vector3d excess_sigma() const noexcept { return excess_variance_.cwiseSqrt(); }
  /// What comes next does not continue what came so far (a new odometry frame). What was learned stays.
  void interrupt() noexcept { fixes_.clear(); }

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.fixes_, self.samples_, self.excess_variance_);
  }

  static constexpr std::size_t kWindow = 60;      ///< samples, 2 s at 30 Hz
  static constexpr std::size_t kMinSamples = 20;  ///< with fewer, the estimate is 0
  static constexpr double kLongestGap_s = 0.5;    ///< over a longer one a leader can do anything
  static constexpr double kMax_m = 0.02;          ///< more than that, and more
  static constexpr double kMax_rad = 0.05;  ///< than that, is no scatter: the other pose of a flat tag is an outlier
  static constexpr double kSubtracted =
      2.0;  ///< times the claimed variance: the median of 60 samples is that uncertain

 private:
  struct Sample {
    Eigen::Vector3d squared = Eigen::Vector3d::Zero(), claimed = Eigen::Vector3d::Zero();
    template <class Self, class Archive>
    static void remember(Self& self, Archive& archive) {
      archive(self.squared, self.claimed);
    }
  };
  BoundedVector<LeaderFix, 4> fixes_;
  BoundedVector<Sample, kWindow> samples_;  ///< by time
  Eigen::Vector3d excess_variance_ = Eigen::Vector3d::Zero();
};

}  // namespace pilotfish::control
PILOTFISH_API_END
