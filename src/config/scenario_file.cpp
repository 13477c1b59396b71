#include "pilotfish/config/scenario_file.hpp"

#include "pilotfish/config/files.hpp"
#include "pilotfish/config/yaml_section.hpp"

namespace pilotfish::config {
namespace {

template <class Config>
void read_whole(YamlSection section, Config& config) {
  section.read(config);
  section.finish();
}

sim::Trajectory read_profile_of(YamlSection& section, sim::Trajectory trajectory) {
  std::visit(
      [&](auto& kind) {
        using Kind = std::decay_t<decltype(kind)>;
        if constexpr (std::is_same_v<Kind, sim::Circle> || std::is_same_v<Kind, sim::FigureEight>) section.read(kind);
        if constexpr (!std::is_same_v<Kind, sim::Still> && !std::is_same_v<Kind, sim::Waypoints>)
          section.read(kind.profile);
      },
      trajectory);
  return trajectory;
}

sim::Waypoints read_waypoints(YamlSection& section) {
  sim::Waypoints waypoints;
  section.read(waypoints);
  for (YamlSection& entry : section.sections("points")) {
    for (const char* key : {"x_m", "y_m"})
      if (!entry.has(key)) throw entry.error(key, "is missing");
    entry.read(waypoints.points.emplace_back());
    entry.finish();
  }
  if (waypoints.points.empty()) throw section.error("points", "needs at least one point");
  return waypoints;
}

sim::Trajectory read_trajectory(YamlSection section) {
  const std::string kind = section.text("kind");
  sim::Trajectory trajectory;
  if (kind == "line") {
    trajectory = read_profile_of(section, sim::Line{});
  } else if (kind == "circle") {
    trajectory = read_profile_of(section, sim::Circle{});
  } else if (kind == "figure_eight") {
    trajectory = read_profile_of(section, sim::FigureEight{});
  } else if (kind == "waypoints") {
    trajectory = read_waypoints(section);
  } else if (kind != "still") {
    throw section.error("kind", "'" + kind + "' is not one of still, line, circle, figure_eight, waypoints");
  }
  section.finish();
  return trajectory;
}

void read_body(YamlSection section, sim::RobotSpec& robot) {
  sim::RobotBody body;
  if (section.optional("leader")) body.leader = parse_leader_body(section.file("leader"));
  section.read(body);
  section.read(robot.visibility);
  section.finish();
  robot.body = body;
}

sim::CameraSpec read_camera(YamlSection section) {
  sim::CameraSpec camera;
  camera.model = parse_calibration(section.file("calibration"));
  if (section.optional("mounting")) read_whole(section.section("mounting"), camera.mounting);
  section.read(camera);
  section.read(camera.imperfections);
  section.finish();
  return camera;
}

sim::RobotSpec read_robot(YamlSection& section) {
  sim::RobotSpec robot;
  robot.name = section.text("name");
  if (section.optional("start")) read_whole(section.section("start"), robot.start);
  if (section.optional("trajectory")) robot.trajectory = read_trajectory(section.section("trajectory"));
  if (section.optional("follows")) robot.follows = section.text("follows");
  if (section.optional("drive")) read_whole(section.section("drive"), robot.drive);
  if (section.optional("body")) read_body(section.section("body"), robot);
  if (section.optional("camera")) robot.camera = read_camera(section.section("camera"));
  if (section.optional("coordinator")) robot.coordinator_file = section.file_path("coordinator");
  if (section.optional("setpoint")) read_whole(section.section("setpoint"), robot.setpoint.emplace());
  section.finish();
  return robot;
}

}  // namespace

sim::Scenario load_scenario(const std::filesystem::path& file) { return parse_scenario(read_text_file(file)); }

sim::Scenario parse_scenario(const TextFile& file) {
  YamlSection root = YamlSection::parse(file);
  sim::Scenario scenario;
  if (!root.has("name")) throw root.error("name", "is missing");
  root.read(scenario);
  for (YamlSection& section : root.sections("robots")) scenario.robots.push_back(read_robot(section));
  root.finish();
  scenario.validate();
  return scenario;
}

}  // namespace pilotfish::config
