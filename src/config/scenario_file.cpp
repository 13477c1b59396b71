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

void read_hardware(const TextFile& file, sim::RobotSpec& robot) {
  YamlSection root = YamlSection::parse(file);
  if (root.optional("drive")) read_whole(root.section("drive"), robot.drive);
  if (root.optional("camera") && robot.camera) {
    YamlSection camera = root.section("camera");
    camera.read(*robot.camera);
    camera.read(robot.camera->imperfections);
    camera.finish();
  }
  root.finish();
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
  if (section.optional("hardware")) read_hardware(section.file("hardware"), robot);
  if (section.optional("coordinator")) robot.coordinator_file = section.file_path("coordinator");
  if (section.optional("radius_m")) robot.radius_m = section.number("radius_m", 0.01, sim::RobotSpec::kMaxRadius_m);
  if (section.optional("range_sensors")) read_whole(section.section("range_sensors"), robot.range_sensors.emplace());
  if (section.optional("setpoint")) read_whole(section.section("setpoint"), robot.setpoint.emplace());
  section.finish();
  return robot;
}

sim::Obstacle read_obstacle(YamlSection& section) {
  for (const char* key : {"x_m", "y_m"})
    if (!section.has(key)) throw section.error(key, "is missing");
  sim::Obstacle obstacle;
  section.read(obstacle);
  section.finish();
  return obstacle;
}

constexpr int kMaxLike = 4;

/// `like`: so many files are like this one already.
sim::Scenario read_scenario(const TextFile& file, int like) {
  YamlSection root = YamlSection::parse(file);
  sim::Scenario scenario;
  const bool other = root.optional("like");
  if (other) {
    if (like == kMaxLike)
      throw root.error("like", "is one too many: a file may be like another, and that like a third, " +
                                   std::to_string(kMaxLike) + " times in all; is one of them like itself?");
    scenario = read_scenario(root.file("like"), like + 1);
  }
  if (!root.has("name")) throw root.error("name", "is missing");
  root.read(scenario);
  if (!other || root.optional("robots")) {
    scenario.robots.clear();
    for (YamlSection& section : root.sections("robots")) scenario.robots.push_back(read_robot(section));
  }
  if (root.optional("obstacles")) {
    scenario.obstacles.clear();
    for (YamlSection& section : root.sections("obstacles")) scenario.obstacles.push_back(read_obstacle(section));
  }
  if (root.optional("obstacle_field"))
    read_whole(root.section("obstacle_field"),
               scenario.obstacle_field ? *scenario.obstacle_field : scenario.obstacle_field.emplace());
  if (root.optional("hardware")) apply_hardware(root.file("hardware"), scenario);
  root.finish();
  return scenario;
}

}  // namespace

sim::Scenario load_scenario(const std::filesystem::path& file) { return parse_scenario(read_text_file(file)); }

sim::Scenario parse_scenario(const TextFile& file) {
  sim::Scenario scenario = read_scenario(file, 0);
  scenario.validate();
  return scenario;
}

void apply_hardware(const TextFile& file, sim::Scenario& scenario) {
  sim::RobotSpec any;  // so that a mistake is found though no robot of the scenario is concerned
  any.camera.emplace();
  read_hardware(file, any);
  for (sim::RobotSpec& robot : scenario.robots)
    if (!robot.follows.empty()) read_hardware(file, robot);
}

}  // namespace pilotfish::config
