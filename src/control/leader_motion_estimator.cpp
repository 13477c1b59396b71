#include "pilotfish/control/leader_motion_estimator.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/utime.hpp"

namespace pilotfish::control {
namespace {

// State: position, velocity, heading, turn rate.
constexpr int kPosition = 0, kVelocity = 2, kHeading = 4, kTurn = 5;

constexpr int kQuiescent = 0, kAbrupt = 2;  // and 1: manoeuvre

// No measurement is taken as more exact than this, because of rounding and of imperfect rigidity.
constexpr double kFloor_m = 2e-5, kFloor_rad = 5e-5;
constexpr double kNoHeading_rad2 = 100.0;  // the variance of an unknown heading
// The prior, for a leader indoors.
constexpr double kUnknownSpeed_mps = 0.5, kUnknownTurn_radps = 0.7;
constexpr std::array<double, 3> kPrior{0.4, 0.4, 0.2};

Eigen::Matrix2d rotation(double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return (Eigen::Matrix2d() << c, -s, s, c).finished();
}

/// Symmetric again after rounding, so that it stays a covariance for hours.
LeaderMatrix symmetric(const LeaderMatrix& matrix) { return 0.5 * (matrix + matrix.transpose()); }

}  // namespace

/// With w the turn rate, a = w dt and R(a) the rotation by a, a coordinated turn moves the leader along a chord:
///
///   p += dt g(a) v,  g(a) = sinc(a/2) R(a/2),     v -> R(a) v,     heading += a
///
/// With J = R(90 deg): dR/da = J R and dg/da = (cos(a/2) - sinc(a/2)) / a R(a/2) + J/2 g(a), so the Jacobian has
///
///   dp/dv = dt g,  dp/dw = dt^2 dg/da v,  dv/dv = R,  dv/dw = dt J R v,  dheading/dw = dt.
///
/// The product of turn rate and velocity is the one term that matters beyond the linear: soon after the start, both are
/// unknown. To second order v -> v + dt J (w v) and p -> p + dt^2/2 J (w v), and with c = cov(v, w) the product w v has
/// the mean w v + c and, about its linear part, the covariance S = cov(v) var(w) + c c^T.
///
/// White noise of density q on dv/dt and dw/dt, integrated over dt, has the covariance
/// q [dt^3/3, dt^2/2; dt^2/2, dt] on (position, velocity) and likewise on (heading, turn rate).
LeaderEstimate predict_leader(const LeaderEstimate& estimate, double velocity_sigma, double turn_sigma,
                              double position_sigma, double dt_s) noexcept {
  const Eigen::Vector2d v = estimate.mean.segment<2>(kVelocity);
  const double a = estimate.mean(kTurn) * dt_s;
  const Eigen::Matrix2d turned = rotation(a), half = rotation(a / 2.0), left = rotation(kPi / 2.0);
  const Eigen::Matrix2d chord = sinc(a / 2.0) * half;
  const double sinc_slope = std::abs(a) < 1e-3 ? -a / 12.0 : (std::cos(a / 2.0) - sinc(a / 2.0)) / a;
  const Eigen::Matrix2d chord_slope = sinc_slope * half + 0.5 * left * chord;

  LeaderEstimate next;
  next.mean = estimate.mean;
  next.mean.segment<2>(kPosition) += dt_s * chord * v;
  next.mean.segment<2>(kVelocity) = turned * v;
  next.mean(kHeading) += a;

  LeaderMatrix f = LeaderMatrix::Identity();
  f.block<2, 2>(kPosition, kVelocity) = dt_s * chord;
  f.block<2, 1>(kPosition, kTurn) = dt_s * dt_s * chord_slope * v;
  f.block<2, 2>(kVelocity, kVelocity) = turned;
  f.block<2, 1>(kVelocity, kTurn) = dt_s * left * turned * v;
  f(kHeading, kTurn) = dt_s;

  LeaderMatrix q = LeaderMatrix::Zero();
  const auto add_walk = [&](int value, int rate, double sigma) {
    const double density = sigma * sigma;
    q(value, value) += density * dt_s * dt_s * dt_s / 3.0;
    q(value, rate) = q(rate, value) = density * dt_s * dt_s / 2.0;
    q(rate, rate) = density * dt_s;
  };
  add_walk(kPosition, kVelocity, velocity_sigma);
  add_walk(kPosition + 1, kVelocity + 1, velocity_sigma);
  add_walk(kHeading, kTurn, turn_sigma);
  q(0, 0) += position_sigma * position_sigma * dt_s;
  q(1, 1) += position_sigma * position_sigma * dt_s;
  const Eigen::Vector2d c = estimate.covariance.block<2, 1>(kVelocity, kTurn);
  const Eigen::Matrix2d product =
      left *
      (estimate.covariance.block<2, 2>(kVelocity, kVelocity) * estimate.covariance(kTurn, kTurn) + c * c.transpose()) *
      left.transpose();
  next.mean.segment<2>(kPosition) += 0.5 * dt_s * dt_s * left * c;
  next.mean.segment<2>(kVelocity) += dt_s * left * c;
  q.block<2, 2>(kPosition, kPosition) += 0.25 * dt_s * dt_s * dt_s * dt_s * product;
  q.block<2, 2>(kVelocity, kVelocity) += dt_s * dt_s * product;
  q.block<2, 2>(kPosition, kVelocity) += 0.5 * dt_s * dt_s * dt_s * product;
  q.block<2, 2>(kVelocity, kPosition) += 0.5 * dt_s * dt_s * dt_s * product;
  next.covariance = symmetric(f * estimate.covariance * f.transpose() + q);
  return next;
}

/// With b = own heading + theta, the leader stands at own + d (cos b, sin b) and looks along own heading + psi. Small
/// errors of (d, theta, psi) move that by
///
///   dx = cos b dd - d sin b dtheta,   dy = sin b dd + d cos b dtheta,   dheading = dpsi.
LeaderMotionEstimator::Outcome LeaderMotionEstimator::update(const Observation& seen, const Pose2& own) noexcept {
  const RelativeMeasurement of_frame = seen.of_this_frame();  // a filtered value must not be filtered again
  const RelativePose& seen_pose = of_frame.pose;
  const double b = own.heading_rad + seen_pose.bearing_rad, d = seen_pose.distance_m;
  Eigen::Matrix3d jacobian;
  jacobian << std::cos(b), -d * std::sin(b), 0.0, std::sin(b), d * std::cos(b), 0.0, 0.0, 0.0, 1.0;
  Measurement z;
  z.mean << own.x_m + d * std::cos(b), own.y_m + d * std::sin(b), own.heading_rad + seen_pose.heading_rad;
  z.covariance = jacobian * of_frame.covariance * jacobian.transpose();
  z.covariance.diagonal() += Eigen::Vector3d(kFloor_m * kFloor_m, kFloor_m * kFloor_m, kFloor_rad * kFloor_rad);
  if (!z.mean.allFinite() || !z.covariance.allFinite() ||
      Eigen::LLT<Eigen::Matrix3d>(z.covariance).info() != Eigen::Success)
    return Outcome::unusable;
  noise_.add({seen.utime, z.mean, z.covariance, b});
  own_noise_.add(seen.utime, z.mean.head<2>(), b);
  z.covariance += noise_.excess_covariance(b);
  const Measurement first = z;

  if (!started_) {
    start(z, seen.utime);
    return Outcome::started;
  }
  const double dt_s = seconds_between(utime_, seen.utime);
  if (!(dt_s > 0.0)) return Outcome::unusable;

  // What mix() and correct() change; a copy of everything would take the window of the noise with it.
  const auto before_modes = modes_;
  const auto before_probability = probability_;
  mix(dt_s);
  const auto mixed_modes = modes_;
  const auto mixed_probability = probability_;
  const double gate2 = config_.gate_sigma * config_.gate_sigma;
  Outcome outcome = Outcome::updated;
  double distance2 = correct(z, dt_s);
  if (!(distance2 <= gate2)) {
    // The other of the two poses of a flat tag has about the same position: use that alone.
    modes_ = mixed_modes;
    probability_ = mixed_probability;
    z.covariance.row(2).setZero();
    z.covariance.col(2).setZero();
    z.covariance(2, 2) = kNoHeading_rad2;
    outcome = Outcome::position_only;
    distance2 = correct(z, dt_s);
  }
  if (!(distance2 <= gate2)) {
    modes_ = before_modes;
    probability_ = before_probability;
    if (++outliers_ < config_.max_outliers) return Outcome::outlier;
    start(first, seen.utime);
    return Outcome::restarted;
  }
  utime_ = seen.utime;
  outliers_ = 0;
  return outcome;
}

/// Corrects all three filters and their probabilities. Returns the squared distance, in standard deviations, of the
/// measurement from the nearest of the three predictions; not a number if it cannot be computed.
double LeaderMotionEstimator::correct(const Measurement& z, double dt_s) noexcept {
  // Likelihoods relative to the best, in logarithms: far from all three they would all be zero.
  std::array<double, 3> log_likelihood{};
  double nearest = std::numeric_limits<double>::infinity();
  for (int mode = 0; mode < 3; ++mode) {
    LeaderEstimate estimate = predicted(mode, dt_s);
    const LeaderMatrix& p = estimate.covariance;
    Eigen::Matrix<double, 6, 3> pht;  // P H^T: the columns of what is measured
    pht << p.col(kPosition), p.col(kPosition + 1), p.col(kHeading);
    Eigen::Matrix3d s;
    s << pht.row(kPosition), pht.row(kPosition + 1), pht.row(kHeading);
    s += z.covariance;
    Eigen::Vector3d innovation = z.mean - Eigen::Vector3d(estimate.mean(0), estimate.mean(1), estimate.mean(kHeading));
    innovation(2) = wrap_angle(innovation(2));
    const Eigen::LLT<Eigen::Matrix3d> cholesky(s);
    if (cholesky.info() != Eigen::Success) return std::numeric_limits<double>::quiet_NaN();
    const double distance2 = cholesky.matrixL().solve(innovation).squaredNorm();
    const Eigen::Matrix3d lower = cholesky.matrixL();
    log_likelihood[mode] = -0.5 * distance2 - lower.diagonal().array().log().sum();
    nearest = std::min(nearest, distance2);
    const Eigen::Matrix<double, 6, 3> gain = cholesky.solve(pht.transpose()).transpose();
    estimate.mean += gain * innovation;
    estimate.covariance = symmetric(p - gain * pht.transpose());
    modes_[mode] = estimate;
  }
  const double best = *std::max_element(log_likelihood.begin(), log_likelihood.end());
  double sum = 0.0;
  for (int mode = 0; mode < 3; ++mode) sum += probability_[mode] *= std::exp(log_likelihood[mode] - best);
  for (double& probability : probability_) probability /= sum;
  return nearest;
}

void LeaderMotionEstimator::start(const Measurement& measured, std::int64_t utime) noexcept {
  LeaderEstimate first;
  first.mean << measured.mean.head<2>(), 0.0, 0.0, measured.mean(2), 0.0;
  const std::array<int, 3> measures{kPosition, kPosition + 1, kHeading};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) first.covariance(measures[i], measures[k]) = measured.covariance(i, k);
  first.covariance(kVelocity, kVelocity) = first.covariance(kVelocity + 1, kVelocity + 1) =
      kUnknownSpeed_mps * kUnknownSpeed_mps;
  first.covariance(kTurn, kTurn) = kUnknownTurn_radps * kUnknownTurn_radps;
  modes_.fill(first);
  probability_ = kPrior;
  utime_ = utime;
  outliers_ = 0;
  started_ = true;
}

/// The leader may have changed its way of moving since the last measurement: with probability
/// 1 - exp(-rate dt) it has, to either of the others alike. Each filter begins from the mixture of all three, weighted
/// by how likely they led to it.
void LeaderMotionEstimator::mix(double dt_s) noexcept {
  const double change = -std::expm1(-config_.change_rate_per_s * dt_s) * (2.0 / 3.0);
  std::array<LeaderEstimate, 3> mixed;
  std::array<double, 3> probability{};
  for (int to = 0; to < 3; ++to) {
    std::array<double, 3> weight{};
    for (int from = 0; from < 3; ++from) {
      weight[from] = (from == to ? 1.0 - change : change / 2.0) * probability_[from];
      probability[to] += weight[from];
    }
    for (int from = 0; from < 3; ++from) mixed[to].mean += weight[from] / probability[to] * modes_[from].mean;
    for (int from = 0; from < 3; ++from) {
      const LeaderVector apart = modes_[from].mean - mixed[to].mean;
      mixed[to].covariance += weight[from] / probability[to] * (modes_[from].covariance + apart * apart.transpose());
    }
  }
  modes_ = mixed;
  probability_ = probability;
}

LeaderEstimate LeaderMotionEstimator::predicted(int mode, double dt_s) const noexcept {
  // An abrupt change happens at once, right after the last measurement: then the whole way it explains was made with
  // the new velocity. Noise spread over dt would model it as the end of a continuing change (1.5 times as much, since
  // cov(p, v) / var(p) = (dt^2/2) / (dt^3/3)), and estimate a leader that stops dead as reversing.
  if (mode == kAbrupt) {
    LeaderEstimate changed = modes_[mode];
    const double velocity = config_.abrupt_velocity_sigma, turn = config_.abrupt_turn_sigma;
    changed.covariance(kVelocity, kVelocity) += velocity * velocity * dt_s;
    changed.covariance(kVelocity + 1, kVelocity + 1) += velocity * velocity * dt_s;
    changed.covariance(kTurn, kTurn) += turn * turn * dt_s;
    return predict_leader(changed, 0.0, 0.0, own_position_sigma(), dt_s);
  }
  const bool quiescent = mode == kQuiescent;
  return predict_leader(modes_[mode], quiescent ? config_.quiescent_velocity_sigma : config_.manoeuvre_velocity_sigma,
                        quiescent ? config_.quiescent_turn_sigma : config_.manoeuvre_turn_sigma, own_position_sigma(),
                        dt_s);
}

double LeaderMotionEstimator::own_position_sigma() const noexcept {
  return std::max(config_.own_position_sigma, own_noise_.sigma());
}

LeaderEstimate LeaderMotionEstimator::at(std::int64_t utime) const noexcept {
  const double dt_s = std::max(seconds_between(utime_, utime), 0.0);
  std::array<LeaderEstimate, 3> ahead;
  LeaderEstimate joined;
  for (int mode = 0; mode < 3; ++mode) {
    ahead[mode] = predicted(mode, dt_s);
    joined.mean += probability_[mode] * ahead[mode].mean;
  }
  for (int mode = 0; mode < 3; ++mode) {
    const LeaderVector apart = ahead[mode].mean - joined.mean;
    joined.covariance += probability_[mode] * (ahead[mode].covariance + apart * apart.transpose());
  }
  return joined;
}

/// With r the unit vector from the coordinator to the leader and l the one to its left, the leader's velocity v has the
/// parts r.v and l.v; their variances are r^T P_v r and l^T P_v l.
LeaderMotion seen_from(const Pose2& own, const LeaderEstimate& leader) noexcept {
  const Eigen::Vector2d offset = leader.mean.head<2>() - Eigen::Vector2d(own.x_m, own.y_m);
  const double direction = std::atan2(offset.y(), offset.x());
  const Eigen::Vector2d r(std::cos(direction), std::sin(direction)), l(-r.y(), r.x());
  const Eigen::Vector2d v = leader.mean.segment<2>(kVelocity);
  const Eigen::Matrix2d p_position = leader.covariance.block<2, 2>(kPosition, kPosition);
  const Eigen::Matrix2d p_velocity = leader.covariance.block<2, 2>(kVelocity, kVelocity);
  LeaderMotion motion;
  motion.distance_m = offset.norm();
  motion.bearing_rad = wrap_angle(direction - own.heading_rad);
  motion.heading_rad = wrap_angle(leader.mean(kHeading) - own.heading_rad);
  motion.radial_mps = r.dot(v);
  motion.tangential_mps = l.dot(v);
  motion.turn_rate_radps = leader.mean(kTurn);
  motion.distance_sigma_m = std::sqrt(std::max(0.0, r.dot(p_position * r)));
  motion.radial_sigma_mps = std::sqrt(std::max(0.0, r.dot(p_velocity * r)));
  motion.tangential_sigma_mps = std::sqrt(std::max(0.0, l.dot(p_velocity * l)));
  return motion;
}

}  // namespace pilotfish::control
