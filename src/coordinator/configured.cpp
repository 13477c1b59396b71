#include "configured.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <utility>

#include "pilotfish/core/angles.hpp"
#include "pilotfish/vision/nearest_visible.hpp"

namespace pilotfish {
namespace {

/// Bearings of the left and the right edge of the picture, at half its height. The camera's place on the robot does not
/// matter at the distances at which a leader is followed.
control::FieldOfView field_of_view(const CameraModel& camera, const CameraMounting& mounting) {
  const auto bearing = [&](double u) {
    const Eigen::Vector2d xy = normalize_pixel(camera, {u, (camera.height - 1) / 2.0});
    const Eigen::Vector3d ray = base_from_camera(mounting).linear() * Eigen::Vector3d(xy.x(), xy.y(), 1.0);
    return std::atan2(ray.y(), ray.x());
  };
  // An edge lies less than half a turn from the middle; a camera that is mounted upside down has them exchanged.
  const double middle = bearing(camera.cx);
  const auto edge = [&](double u) {
    const double bearing_rad = bearing(u), from_middle = bearing_rad - middle;
    return std::abs(from_middle) <= kPi ? bearing_rad : bearing_rad - std::copysign(2.0 * kPi, from_middle);
  };
  const auto [right_rad, left_rad] = std::minmax({edge(camera.width - 0.5), edge(-0.5)});
  return {right_rad, left_rad};
}

/// With a camera whose view contains none of the allowed bearings the robot could never drive.
void check_view(const control::FieldOfView& view) {
  if (view.left_rad > -kMaxBearing_rad && view.right_rad < kMaxBearing_rad) return;
  std::ostringstream problem;
  problem << "the camera sees bearings from " << degrees(view.right_rad) << " to " << degrees(view.left_rad)
          << " deg only; a leader is followed at -" << degrees(kMaxBearing_rad) << " to " << degrees(kMaxBearing_rad)
          << " deg, ahead of the robot";
  throw ConfigError("camera.mounting.pan_deg", problem.str());
}

void check_blind_travel(const CoordinatorConfig& config) {
  const double max_age_s = config.safety.max_age_s;
  const double top_mps = std::max(config.control.limits.max_linear_mps, config.control.limits.max_reverse_mps);
  if (max_age_s <= kOrdinaryMaxAge_s || max_age_s * top_mps <= kMaxBlindTravel_m * (1.0 + 1e-9)) return;
  std::ostringstream problem;
  problem << max_age_s << " s at " << top_mps << " m/s is " << max_age_s * top_mps << " m of blind travel, more than "
          << kMaxBlindTravel_m << " m; lower control.limits.max_linear_mps and max_reverse_mps to "
          << kMaxBlindTravel_m / max_age_s << ", or max_age_s to " << kOrdinaryMaxAge_s;
  throw ConfigError("safety.max_age_s", problem.str());
}

/// The leader must still be visible at the guard distance: otherwise the robot stops, without sight of it, before
/// the guard acts, or is hit.
void check_guard(const CoordinatorConfig& config, const vision::TagTracker& tracker) {
  const double guard_m = config.control.guard.minimum_distance_m;
  const double nearest_m = vision::nearest_visible_distance_m(tracker, config.mounting);
  if (nearest_m <= guard_m) return;
  std::ostringstream problem;
  problem << guard_m << " m is nearer than " << nearest_m
          << " m, the nearest distance at which this camera, where it is "
          << "mounted, can see a tag of this leader; allowed: " << nearest_m
          << " to 20 m, or mount the camera and the tags "
          << "farther apart or at more nearly the same height";
  throw ConfigError("control.guard.minimum_distance_m", problem.str());
}

/// Below the alternative's key: a body that is read from a file is at fault there.
template <class Make>
auto of_alternative(const std::string& key, Make&& make) {
  try {
    return std::forward<Make>(make)();
  } catch (const ConfigError& error) {
    const std::string said = error.what();
    throw ConfigError(error.key().rfind("leader", 0) == 0 ? key + "." + error.key() : error.key(),
                      said.substr(error.key().size() + 2) + " (of " + key + ")");
  }
}

std::string alternative_key(std::size_t index) { return "alternatives.leaders[" + std::to_string(index) + "]"; }

/// One search finds everybody's tags, and an id says whose tag it is.
void check_ids(const CoordinatorConfig& config) {
  std::map<int, std::string> owners;
  for (const BodyTag& tag : config.leader.tags) owners.emplace(tag.id, "leader");
  for (std::size_t i = 0; i < config.other_leaders.size(); ++i) {
    const LeaderBody& body = config.other_leaders[i].leader;
    const std::string key = alternative_key(i) + ".leader";
    if (body.family != config.leader.family)
      throw ConfigError(key, "wears " + body.family + ", and the first leader " + config.leader.family +
                                 "; all must wear tags of one family");
    for (const BodyTag& tag : body.tags)
      if (const auto [owner, is_new] = owners.emplace(tag.id, key); !is_new)
        throw ConfigError(key, "wears tag " + std::to_string(tag.id) + ", as " + owner->second +
                                   " does; no two leaders may have an id in common");
  }
}

void check_not_too_near(double distance_m, const SafetyConfig& safety, const std::string& key) {
  if (!(distance_m < safety.stop_distance_m)) return;
  std::ostringstream problem;
  problem << distance_m << " is below safety.stop_distance_m (" << safety.stop_distance_m << ")";
  throw ConfigError(key, problem.str());
}

}  // namespace

control::FollowerConfig with_view(const CoordinatorConfig& config) {
  control::FollowerConfig control = config.control;
  control.view = field_of_view(config.camera, config.mounting);
  check_view(control.view);
  control.hold_s = config.safety.max_age_s;
  return control;
}

std::vector<vision::LeaderObserver> observers_of(const CoordinatorConfig& config) {
  std::vector<vision::LeaderObserver> observers;
  observers.reserve(1 + config.other_leaders.size());
  observers.emplace_back(config.camera, config.mounting, config.leader, config.vision);
  for (std::size_t i = 0; i < config.other_leaders.size(); ++i)
    of_alternative(alternative_key(i), [&] {
      observers.emplace_back(config.camera, config.mounting, config.other_leaders[i].leader, config.vision);
    });
  return observers;
}

std::vector<Setpoint> setpoints_of(const CoordinatorConfig& config) {
  std::vector<Setpoint> setpoints = {config.setpoint};
  for (const AlternativeLeader& other : config.other_leaders)
    setpoints.push_back({other.distance_m, other.bearing_rad, config.setpoint.run});
  return setpoints;
}

void check(const CoordinatorConfig& config, const std::vector<vision::LeaderObserver>& observers) {
  check_ranges(config.safety, "safety");
  check_ranges(config.setpoint, "setpoint");
  check_blind_travel(config);
  check_guard(config, observers.front().tracker());
  check_not_too_near(config.setpoint.distance_m, config.safety, "setpoint.distance_m");
  check_ids(config);
  for (std::size_t i = 0; i < config.other_leaders.size(); ++i) {
    const AlternativeLeader& other = config.other_leaders[i];
    const std::string key = alternative_key(i);
    check_ranges(other, key);
    check_not_too_near(other.distance_m, config.safety, key + ".distance_m");
    of_alternative(key, [&] { check_guard(config, observers[i + 1].tracker()); });
  }
}

}  // namespace pilotfish
