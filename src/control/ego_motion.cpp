#include "pilotfish/control/ego_motion.hpp"

#include <algorithm>
#include <cmath>

#include "pilotfish/core/utime.hpp"

namespace pilotfish::control {
namespace {

constexpr double kArc_s = 0.005;      // the path is made of arcs of so long; error below 0.01 mm for such robots
constexpr double kForgotten_s = 2.0;  // after this long with one command the robot has reached it

Twist plus(const Twist& a, const Twist& b, double factor) {
  return {a.linear_mps + factor * b.linear_mps, a.angular_radps + factor * b.angular_radps};
}

std::int64_t covered_until(std::int64_t measured_utime) { return later_s(measured_utime, EgoMotion::kCovered_s); }

}  // namespace

std::string_view to_string(EgoMotionSource source) noexcept {
  return source == EgoMotionSource::odometry ? "odometry" : "commanded";
}

EgoMotion::EgoMotion(const DriveModelConfig& drive, const LimitsConfig& limits) : drive_(drive), limits_(limits) {}

void EgoMotion::command(const Twist& twist, std::int64_t acts_utime) noexcept {
  if (!is_finite(twist)) return;  // never sent: the coordinator stops instead
  if (pending_.full()) take_first_pending();
  pending_.push_back({twist, acts_utime});
}

bool EgoMotion::measured(std::int64_t utime, const Twist& twist) noexcept {
  const double fastest_mps = kBeyondLimits * std::max(limits_.max_linear_mps, limits_.max_reverse_mps);
  // Not a number is not within a limit either.
  if (!(std::abs(twist.linear_mps) <= fastest_mps) ||
      !(std::abs(twist.angular_radps) <= kBeyondLimits * limits_.max_angular_radps))
    return false;
  if (started_ && utime <= utime_) return false;  // that time has been accounted for
  if (!measured_.empty() && utime <= measured_.back().utime) return false;
  if (measured_.full()) measured_.pop_front();
  measured_.push_back({twist, utime});
  return true;
}

void EgoMotion::advance_to(std::int64_t utime) noexcept {
  if (!started_) utime_ = utime;
  started_ = true;
  take_due_measurements();
  while (utime_ < utime) {
    while (!pending_.empty() && pending_.front().acts_utime <= utime_) take_first_pending();
    std::int64_t next = utime;
    if (!pending_.empty()) next = std::min(next, pending_.front().acts_utime);
    if (!measured_.empty()) next = std::min(next, measured_.front().utime);
    if (last_measured_utime_) next = std::min(next, covered_until(*last_measured_utime_));
    drive_for(seconds_between(utime_, next));
    utime_ = next;
    take_due_measurements();
    if (last_measured_utime_ && covered_until(*last_measured_utime_) <= utime_) forget_odometry();
  }
}

/// Since the measurement before, the error of the model has come to this, in a straight line: the mean of what is added
/// is half of it, and the way is corrected by that at its end.
void EgoMotion::take_due_measurements() noexcept {
  while (!measured_.empty() && measured_.front().utime <= utime_) {
    const Measured now = measured_.front();
    measured_.pop_front();
    const Twist error = plus(now.twist, twist_, -1.0);
    if (last_measured_utime_) {
      const double since_s = seconds_between(*last_measured_utime_, now.utime);
      const double filter_s = drive_.odometry_filter_s;
      const double weight = filter_s > 0.0 ? -std::expm1(-since_s / filter_s) : 1.0;
      const Twist added = plus(error, model_error_, -1.0);
      pose_ = move_along_arc(pose_, plus(Twist{}, added, 0.5 * weight), since_s);
      model_error_ = plus(model_error_, added, weight);
    } else {
      model_error_ = error;
    }
    last_measured_utime_ = now.utime;
  }
}

void EgoMotion::forget_odometry() noexcept {
  last_measured_utime_.reset();
  model_error_ = Twist{};
}

void EgoMotion::set_delays(double actuator_lag_s, std::int64_t later_by_us) noexcept {
  drive_.actuator_lag_s = actuator_lag_s;
  for (Command& each : pending_) each.acts_utime += later_by_us;
}

void EgoMotion::take_first_pending() noexcept {
  acting_ = pending_.front().twist;
  pending_.pop_front();
}

void EgoMotion::drive_for(double duration_s) noexcept {
  if (duration_s > kForgotten_s) {
    twist_ = set_value_ = acting_;
    pose_ = move_along_arc(pose_, twist_, duration_s);
    return;
  }
  const int arcs = std::max(1, static_cast<int>(std::ceil(duration_s / kArc_s)));
  const double dt_s = duration_s / arcs;
  if (!(dt_s > 0.0)) return;
  for (int arc = 0; arc < arcs; ++arc) {
    Twist mean;
    mean.linear_mps = follow_set_value(twist_.linear_mps, set_value_.linear_mps, acting_.linear_mps,
                                       limits_.max_linear_acceleration_mps2, drive_.actuator_lag_s, dt_s) /
                      dt_s;
    mean.angular_radps = follow_set_value(twist_.angular_radps, set_value_.angular_radps, acting_.angular_radps,
                                          limits_.max_angular_acceleration_radps2, drive_.actuator_lag_s, dt_s) /
                         dt_s;
    if (last_measured_utime_) mean = plus(mean, model_error_, 1.0);
    pose_ = move_along_arc(pose_, mean, dt_s);
  }
}

}  // namespace pilotfish::control
