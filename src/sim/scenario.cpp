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

void Scenario::validate() const {
  check_ranges(*this, "");
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
