#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/core/bounded_vector.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// Dead-reckoning drift of the robot along the line of sight: wheels slip, turn in steps and respond late. Learned from
/// the measurements of the leader alone, nothing to set.
///
/// The drift is a random walk, of variance q per second; noise of a measurement is new in every one. The normalised
/// third difference r of four measurements (see MeasurementNoise) has from both the variance
///
///   s^2 + q W,     W = sum_k (t_k+1 - t_k) (w_0 + ... + w_k)^2 / sum w_i^2,
///
/// which is 0.3 of their distance in time, if that is even. So what grows where the four lie farther apart is the walk.
/// With m the quantile of r^2 over the last frames, over that of chi-square with one degree of freedom, of four in a
/// row and of every sixth:
///
///   q = (m_6 - kMargin m_1) / (W_6 - kMargin W_1),     at least 0.
///
/// With kMargin = 1 that would be the walk itself, and as often as not noise without any; with more, what is found of a
/// walk that is much more than the noise is still nearly all of it. The quantile lies high, as a wheel that turns in
/// steps errs seldom but by much, and not so high that it is disturbed by a leader which stops dead, in 18 of 120
/// samples.
class OwnMotionNoise {
 public:
  /// The next measurement, in the odometry frame. One that is not newer than the last, or comes after a gap, begins
  /// anew with the differences.
  void add(std::int64_t utime, const Eigen::Vector2d& leader_m, double line_of_sight_rad) noexcept;
  /// sqrt(q) [m per sqrt(s)]; 0 until enough is known.
  double sigma() const noexcept { return sigma_; }
  /// What comes next does not continue what came so far (a new odometry frame). What was learned stays.
  void interrupt() noexcept { places_.clear(); }

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.places_, self.samples_, self.sigma_);
  }

  static constexpr std::size_t kWindow = 120;     ///< samples, 4 s at 30 Hz
  static constexpr std::size_t kMinSamples = 60;  ///< with fewer, the estimate is 0
  static constexpr double kLongestGap_s = 0.5;    ///< over a longer one a leader can do anything
  static constexpr double kMargin = 1.3;          ///< see above
  static constexpr double kMax = 0.002;  ///< more [m per sqrt(s)] would take too much of what the leader does for it

 private:
  static constexpr std::size_t kStride = 6;
  struct Place {
    std::int64_t utime = 0;
    Eigen::Vector2d leader_m = Eigen::Vector2d::Zero();
    template <class Self, class Archive>
    static void remember(Self& self, Archive& archive) {
      archive(self.utime, self.leader_m);
    }
  };
  /// r^2 and W of four in a row, and of every sixth.
  struct Sample {
    double near_m2 = 0.0, near_s = 0.0, far_m2 = 0.0, far_s = 0.0;
    template <class Self, class Archive>
    static void remember(Self& self, Archive& archive) {
      archive(self.near_m2, self.near_s, self.far_m2, self.far_s);
    }
  };
  using Places = BoundedVector<Place, 3 * kStride + 1>;
  struct Difference {
    double squared_m2 = 0.0, walk_s = 0.0;
  };
  Difference difference(std::size_t stride, const Eigen::Vector2d& line_of_sight) const noexcept;

  Places places_;
  BoundedVector<Sample, kWindow> samples_;  ///< by time
  double sigma_ = 0.0;
};

}  // namespace pilotfish::control
PILOTFISH_API_END
