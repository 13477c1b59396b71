#include "pilotfish/control/own_motion.hpp"

#include <algorithm>
#include <cmath>

namespace pilotfish::control {
namespace {

constexpr double kArc_s = 0.005;      // the path is made of arcs of so long; error below 0.01 mm for such robots
constexpr double kForgotten_s = 2.0;  // after so long with one command the robot does just that

}  // namespace

const std::vector<Parameter<DriveModelConfig>>& DriveModelConfig::parameters() {
  using C = DriveModelConfig;
  static const std::vector<Parameter<C>> table = {
      {"latency_s", &C::latency_s, 0.0, 0.25, "from the exposure to the moment the command that answers it acts"},
      {"actuator_lag_s", &C::actuator_lag_s, 0.0, 1.0, "time constant of the wheels' speed control; 0: none"},
  };
  return table;
}

OwnMotion::OwnMotion(const DriveModelConfig& drive, const LimitsConfig& limits) : drive_(drive), limits_(limits) {}

void OwnMotion::command(const Twist& twist, std::int64_t acts_utime) noexcept {
  if (!is_finite(twist)) return;  // never obeyed: the coordinator stops instead
  if (pending_count_ == static_cast<int>(pending_.size())) take_first_pending();
  pending_[pending_count_++] = {twist, acts_utime};
}

void OwnMotion::advance_to(std::int64_t utime) noexcept {
  if (!started_) utime_ = utime;
  started_ = true;
  while (utime_ < utime) {
    while (pending_count_ > 0 && pending_[0].acts_utime <= utime_) take_first_pending();
    const std::int64_t next = pending_count_ > 0 ? std::min(utime, pending_[0].acts_utime) : utime;
    drive_for(static_cast<double>(next - utime_) * 1e-6);
    utime_ = next;
  }
}

void OwnMotion::take_first_pending() noexcept {
  acting_ = pending_[0].twist;
  std::move(pending_.begin() + 1, pending_.begin() + pending_count_, pending_.begin());
  --pending_count_;
}

void OwnMotion::drive_for(double duration_s) noexcept {
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
    pose_ = move_along_arc(pose_, mean, dt_s);
  }
}

}  // namespace pilotfish::control
