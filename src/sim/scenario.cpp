#include "pilotfish/sim/scenario.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "pilotfish/core/robot_name.hpp"

namespace pilotfish::sim {
namespace {

template <class Config>
void check_part(const std::optional<Config>& part, const std::string& section) {
  if (part) check_ranges(*part, section);
}

void check_field(const std::optional<ObstacleField>& field) {
  if (!field) return;
  check_ranges(*field, "obstacle_field");
  const auto check_order = [](double least, double most, const std::string& key, const char* other) {
    if (least <= most) return;
    throw ConfigError("obstacle_field." + key,
                      std::to_string(most) + " is below " + other + " (" + std::to_string(least) + ")");
  };
  check_order(field->x_min_m, field->x_max_m, "x_max_m", "x_min_m");
  check_order(field->y_min_m, field->y_max_m, "y_max_m", "y_min_m");
  check_order(field->radius_min_m, field->radius_max_m, "radius_max_m", "radius_min_m");
  check_order(field->height_min_m, field->height_max_m, "height_max_m", "height_min_m");
}

}  // namespace

CameraModel real_model(const CameraSpec& camera) {
  CameraModel model = camera.model;
  model.fx *= 1.0 + camera.focal_error;
  model.fy *= 1.0 + camera.focal_error;
  return model;
}

CameraMounting real_mounting(const CameraSpec& camera) {
  CameraMounting mounting = camera.mounting;
  mounting.pan_rad += camera.pan_error_rad;
  mounting.tilt_rad += camera.tilt_error_rad;
  return mounting;
}

const RobotSpec* Scenario::find(const std::string& robot) const {
  const auto found =
      std::find_if(robots.begin(), robots.end(), [&](const RobotSpec& spec) { return spec.name == robot; });
  return found == robots.end() ? nullptr : &*found;
}

int Scenario::frame_count() const { return static_cast<int>(std::ceil(duration_s * frame_rate_hz - 1e-9)); }

/// A path is taken at every 50 ms: with 5 m/s its points are 0.25 m apart, and leave it by less than any radius.
std::vector<Obstacle> Scenario::all_obstacles() const {
  std::vector<Obstacle> all = obstacles;
  if (!obstacle_field) return all;
  constexpr double kStep_s = 0.05;
  std::vector<Pose2> clear;
  for (const RobotSpec& robot : robots) {
    clear.push_back(robot.start);
    if (!robot.trajectory) continue;
    for (double time_s = 0.0; time_s < duration_s; time_s += kStep_s)
      clear.push_back(state_at(*robot.trajectory, robot.start, time_s).pose);
  }
  const int own = obstacle_field->seed != 0 ? obstacle_field->seed : seed;
  const std::vector<Obstacle> drawn = obstacles_of(*obstacle_field, static_cast<std::uint64_t>(own), clear, obstacles);
  all.insert(all.end(), drawn.begin(), drawn.end());
  return all;
}

void Scenario::validate() const {
  check_ranges(*this, "");
  for (std::size_t i = 0; i < obstacles.size(); ++i) check_ranges(obstacles[i], "obstacles[" + std::to_string(i) + "]");
  check_field(obstacle_field);
  check_robot_name(name, "name");
  if (robots.empty()) throw ConfigError("robots", "a world needs at least one robot");
  std::set<std::string> words;
  for (std::size_t i = 0; i < robots.size(); ++i) {
    const RobotSpec& robot = robots[i];
    const std::string key = "robots[" + std::to_string(i) + "]";
    check_robot_name(robot.name, key + ".name");
    if (!words.insert(channel_word(robot.name)).second)
      throw ConfigError(key + ".name", "'" + robot.name + "' is used twice");
    check_ranges(robot.start, key + ".start");
    check_ranges(robot.drive, key + ".drive");
    check_part(robot.body, key + ".body");
    check_ranges(robot.visibility, key + ".body");
    if (robot.visibility.hidden_until_s < robot.visibility.hidden_from_s)
      throw ConfigError(key + ".body.hidden_until_s", "is before hidden_from_s");
    if (robot.body && !robot.body->leader.tags.empty()) robot.body->leader.validate();
    check_part(robot.setpoint, key + ".setpoint");
    check_part(robot.range_sensors, key + ".range_sensors");
    if (const auto problem = outside(robot.radius_m, 0.01, RobotSpec::kMaxRadius_m))
      throw ConfigError(key + ".radius_m", *problem);
    if (robot.camera) {
      robot.camera->model.validate();
      check_ranges(*robot.camera, key + ".camera");
      if (robot.camera->latency_jitter_s > robot.camera->latency_s)
        throw ConfigError(key + ".camera.latency_jitter_s",
                          std::to_string(robot.camera->latency_jitter_s) + " is more than latency_s (" +
                              std::to_string(robot.camera->latency_s) +
                              "), as its camera section or its hardware file has them: a command cannot act before its "
                              "picture");
      check_ranges(robot.camera->mounting, key + ".camera.mounting");
      check_ranges(robot.camera->imperfections, key + ".camera");
    }
    if (robot.follows.empty()) continue;
    const std::string follows = key + ".follows";
    const RobotSpec* leader = find(robot.follows);
    if (leader == nullptr) throw ConfigError(follows, "there is no robot '" + robot.follows + "'");
    if (leader == &robot) throw ConfigError(follows, "a robot cannot follow itself");
    if (!leader->body || leader->body->leader.tags.empty())
      throw ConfigError(follows, "'" + robot.follows + "' wears no tags to follow it by");
    if (robot.trajectory) throw ConfigError(key + ".trajectory", "a robot that follows another has none of its own");
    if (!robot.camera) throw ConfigError(key + ".camera", "a robot that follows another needs one");
  }
}

}  // namespace pilotfish::sim
