#include <pybind11/eigen.h>
#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "exclusive.hpp"
#include "parameters.hpp"
#include "pilotfish/config/scenario_file.hpp"
#include "pilotfish/sim/awaited_answers.hpp"
#include "pilotfish/sim/recorder.hpp"
#include "pilotfish/sim/world.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::python;
using namespace pilotfish::sim;

namespace {

void bind_motion(py::module_& m) {
  py::class_<Pose2>(m, "Pose2", "A pose on the ground in the world frame.")
      .def(py::init([](double x_m, double y_m, double heading_rad) {
             return Pose2{x_m, y_m, heading_rad};
           }),
           py::kw_only(), py::arg("x_m") = 0.0, py::arg("y_m") = 0.0, py::arg("heading_rad") = 0.0,
           "x_m, y_m [m] and heading_rad [rad] in the world frame (x, y on the ground, heading from x to the left).")
      .def_readonly("x_m", &Pose2::x_m, "[m], in the world frame")
      .def_readonly("y_m", &Pose2::y_m, "[m], in the world frame")
      .def_readonly("heading_rad", &Pose2::heading_rad, "[rad] from the world's x axis, positive: to the left");
  add_repr(m, "Pose2");  // shown in signatures below
  py::class_<UnicycleState>(m, "UnicycleState", "Where a robot is and how fast it really moves.")
      .def_readonly("pose", &UnicycleState::pose, "Pose2 of the base in the world frame")
      .def_readonly("twist", &UnicycleState::twist, "Twist that the wheels really do, in the base frame");
  bind_parameters<DriveConfig>(m, "DriveConfig", "What a drive can do, and how late it does it.");
  m.def("move_along_arc", &move_along_arc, "The pose after dt_s with a constant twist, exactly.", py::arg("pose"),
        py::arg("twist"), py::arg("dt_s"));
  py::class_<Unicycle>(m, "Unicycle", "A differential-drive robot behind its wheel driver.")
      .def(py::init<const DriveConfig&, const Pose2&>(), py::arg("drive"), py::arg("start") = Pose2{},
           "drive: DriveConfig; start: Pose2, at rest.")
      .def_property_readonly("state", &Unicycle::state, "UnicycleState: pose and real twist now")
      .def_property_readonly("set_value", &Unicycle::set_value, "the driver's ramp behind which the wheels lag")
      .def("advance", &Unicycle::advance, "Executes one constant command for duration_s [s].", py::arg("command"),
           py::arg("duration_s"), py::call_guard<py::gil_scoped_release>());
}

void bind_trajectories(py::module_& m) {
  bind_parameters<SpeedProfile>(m, "SpeedProfile", "Speed along a path: from rest, along, and back to rest.");
  py::class_<Still>(m, "Still", "Stands where it starts.").def(py::init<>(), "A trajectory that stays at the start.");
  py::class_<Line>(m, "Line", "Straight ahead.")
      .def(py::init([](const SpeedProfile& profile) { return Line{profile}; }), py::arg("profile") = SpeedProfile{},
           "profile: SpeedProfile along the line.")
      .def_readonly("profile", &Line::profile, "SpeedProfile along the line");
  py::class_<Circle>(m, "Circle", "A circular arc.")
      .def(py::init([](double radius_m, bool clockwise, const SpeedProfile& profile) {
             Circle circle{radius_m, clockwise, profile};
             check_ranges(circle, "circle");
             return circle;
           }),
           py::kw_only(), py::arg("radius_m") = 1.0, py::arg("clockwise") = false, py::arg("profile") = SpeedProfile{},
           "radius_m [m]; clockwise: turns to the right; profile: SpeedProfile along the arc. ConfigError on a number "
           "out of range.")
      .def_readonly("radius_m", &Circle::radius_m, "[m], of the base's origin")
      .def_readonly("clockwise", &Circle::clockwise, "True: turns to the right; False: to the left")
      .def_readonly("profile", &Circle::profile, "SpeedProfile along the arc");
  py::class_<FigureEight>(m, "FigureEight", "Gerono's lemniscate at constant speed along its arc.")
      .def(py::init([](double half_length_m, double half_width_m, const SpeedProfile& profile) {
             FigureEight eight{half_length_m, half_width_m, profile};
             check_ranges(eight, "figure_eight");
             return eight;
           }),
           py::kw_only(), py::arg("half_length_m") = 1.5, py::arg("half_width_m") = 1.0,
           py::arg("profile") = SpeedProfile{},
           "x = a sin p, y = b sin p cos p; half_length_m: a [m], half_width_m: b [m]. ConfigError on a number out of "
           "range.")
      .def_property_readonly("lap_length_m", &lap_length_m, "length of one lap [m]")
      .def_readonly("profile", &FigureEight::profile, "SpeedProfile along the arc");
  bind_parameters<Waypoint>(m, "Waypoint", "A point to drive to, in the frame of the start.");
  bind_parameters<Waypoints>(m, "Waypoints", "From point to point: turn on the spot, drive, stop, wait.")
      .def_readwrite("points", &Waypoints::points, "list of Waypoint; getting it gives a copy, so set it as a whole");
  m.def("state_at", &state_at, "UnicycleState on the trajectory that begins at `start`, exactly.",
        py::arg("trajectory"), py::arg("start"), py::arg("time_s"), py::call_guard<py::gil_scoped_release>());
}

void bind_rendering(py::module_& m) {
  bind_parameters<Imperfections>(m, "Imperfections", "What lies between an ideal picture and a camera's.");
  bind_parameters<RobotBody>(m, "RobotBody", "What a robot looks like: a box, and tags.")
      .def_readwrite("leader", &RobotBody::leader, "LeaderBody: its tags");
  py::class_<Renderer>(m, "Renderer", "A camera, as a function of what is in front of it.")
      .def(py::init([](const CameraModel& camera, const Imperfections& imperfections, const CameraMounting& mounting,
                       std::uint64_t clutter_seed) {
             const py::gil_scoped_release unlocked;
             return std::make_unique<Renderer>(camera, mounting, imperfections, clutter_seed);
           }),
           py::arg("camera"), py::arg("imperfections") = Imperfections{}, py::arg("mounting") = CameraMounting{},
           py::kw_only(), py::arg("clutter_seed") = 1,
           "camera: size and lens; mounting: on the robot's base; clutter_seed: of the background. The same arguments "
           "give the same bytes. ConfigError names what is out of range.")
      .def(
          "render",
          [](const Renderer& renderer, const std::vector<std::pair<RobotBody, DoubleArray>>& bodies,
             double camera_heading_rad, std::uint64_t seed) {
            std::vector<std::vector<Surface>> surfaces(bodies.size());
            View view;
            view.camera_heading_rad = camera_heading_rad;
            for (std::size_t i = 0; i < bodies.size(); ++i)
              view.bodies.push_back({&surfaces[i], to_pose(bodies[i].second)});
            std::vector<std::uint8_t> pixels;
            {
              const py::gil_scoped_release released;
              for (std::size_t i = 0; i < bodies.size(); ++i) surfaces[i] = surfaces_of(bodies[i].first);
              pixels = renderer.render({view}, seed);
            }
            const CameraModel& camera = renderer.camera();
            return to_array(ImageView{pixels.data(), pixels.size(), camera.width, camera.height, camera.width});
          },
          "(H, W) uint8 of the bodies, given as a list of (RobotBody, cMo (4, 4)); seed: of the noise.",
          py::arg("bodies"), py::kw_only(), py::arg("camera_heading_rad") = 0.0, py::arg("seed") = 1);
  m.def(
      "render_view",
      [](const py::object& camera, const py::object& leader, const py::object& cMo, const py::object& imperfections,
         std::uint64_t seed) {
        RobotBody body;
        body.leader = leader.cast<LeaderBody>();
        const auto lens = camera.cast<CameraModel>();
        const auto flaws = imperfections.cast<Imperfections>();
        std::optional<Renderer> renderer;
        {
          const py::gil_scoped_release released;
          renderer.emplace(lens, CameraMounting{}, flaws, seed);
        }
        return py::cast(&*renderer, py::return_value_policy::reference)
            .attr("render")(py::make_tuple(py::make_tuple(body, cMo)), py::arg("seed") = seed);
      },
      "(H, W) uint8 of a leader's tags alone, in front of clutter; a Renderer is faster for many pictures.",
      py::arg("camera"), py::arg("leader"), py::arg("cMo"), py::kw_only(), py::arg("imperfections") = Imperfections{},
      py::arg("seed") = 1);
}

void bind_obstacles(py::module_& m) {
  bind_parameters<Obstacle>(m, "Obstacle", "A cylinder that stands on the ground.");
  bind_parameters<ObstacleField>(m, "ObstacleField", "Obstacles that are drawn at random.");
  bind_parameters<RangeSensors>(m, "RangeSensors", "A ring of range sensors around a robot, or a laser.");
}

void bind_scenario(py::module_& m) {
  bind_parameters<CameraSpec>(m, "CameraSpec",
                              "A robot's own camera. The errors are unknown to the coordinator: the world has "
                              "them, no configuration does.")
      .def_readwrite("model", &CameraSpec::model, "CameraModel: size and lens, without focal_error")
      .def_readwrite("mounting", &CameraSpec::mounting, "CameraMounting: where it sits, without the errors")
      .def_readwrite("imperfections", &CameraSpec::imperfections, "Imperfections of its pictures");
  bind_parameters<Visibility>(m, "Visibility", "When a robot is invisible.");
  py::class_<RobotSpec>(m, "RobotSpec", "One robot of the world.")
      .def(py::init<>(), "Defaults; set the attributes. Scenario.validate() checks them.")
      .def_readwrite("name", &RobotSpec::name, "name of the robot: its channels and its noise come from it")
      .def_readwrite("start", &RobotSpec::start, "Pose2 at time 0 in the world frame")
      .def_readwrite("trajectory", &RobotSpec::trajectory, "None: it follows a leader or executes commands")
      .def_readwrite("follows", &RobotSpec::follows, "name of its leader; empty if none")
      .def_readwrite("drive", &RobotSpec::drive, "DriveConfig: what its wheels can do")
      .def_readwrite("body", &RobotSpec::body, "RobotBody that others see; None: it is invisible")
      .def_readwrite("visibility", &RobotSpec::visibility, "Visibility: when it is invisible")
      .def_readwrite("camera", &RobotSpec::camera, "CameraSpec, or None if it has no camera")
      .def_property_readonly(
          "coordinator_file",
          [](const RobotSpec& robot) -> std::optional<std::filesystem::path> {
            if (robot.coordinator_file.empty()) return std::nullopt;
            return robot.coordinator_file;
          },
          "configuration of the coordinator that drives it; None if there is none")
      .def_readwrite("setpoint", &RobotSpec::setpoint, "None: what the coordinator's file says")
      .def_readwrite("radius_m", &RobotSpec::radius_m, "of the circle around its base origin that is its outline [m]")
      .def_readwrite("range_sensors", &RobotSpec::range_sensors, "RangeSensors, or None if it has none");
  bind_parameters<Scenario>(m, "Scenario", "A world to play: robots, time, seed.")
      .def_readwrite("robots", &Scenario::robots, "list of RobotSpec; getting it gives a copy, so set it as a whole")
      .def_readwrite("obstacles", &Scenario::obstacles, "list of Obstacle; getting it gives a copy")
      .def_readwrite("obstacle_field", &Scenario::obstacle_field,
                     "ObstacleField: more of them, drawn at random; None: no more")
      .def("all_obstacles", &Scenario::all_obstacles,
           "obstacles, and those of the field. ValueError if they do not fit.")
      .def_property_readonly("frame_count", &Scenario::frame_count,
                             "number of exposures, at k / frame_rate_hz, k = 0, 1, ... < duration_s")
      .def(
          "robot",
          [](const Scenario& scenario, const std::string& name) {
            if (const RobotSpec* robot = scenario.find(name)) return *robot;
            throw py::key_error("there is no robot '" + name + "' in the scenario");
          },
          "A copy of the robot of that name.", py::arg("name"))
      .def("validate", &Scenario::validate, "ValueError names the key at fault.");
  m.def(
      "with_hardware",
      [](sim::Scenario scenario, const std::filesystem::path& file) {
        config::apply_hardware(config::read_text_file(file), scenario);
        scenario.validate();
        return scenario;
      },
      py::arg("scenario"), py::arg("path"),
      "The Scenario with robots as that file says, such as hardware/nonideal.yaml: its sections drive and camera count "
      "in "
      "place of what the scenario says of each robot that follows another. ConfigError names the key at fault.");
  m.def("load_scenario", &config::load_scenario, "ValueError names the key at fault.", py::arg("path"),
        py::call_guard<py::gil_scoped_release>());
}

void bind_world(py::module_& m) {
  m.attr("START_UTIME") = kStartUtime;
  py::class_<World>(m, "World", "The world of a scenario. It has no clock: it is advanced.")
      .def(py::init<Scenario>(), py::arg("scenario"), py::call_guard<py::gil_scoped_release>(),
           "ValueError (ConfigError) names the key if the scenario is not valid.")
      .def_property_readonly("scenario", exclusive([](const World& world) { return world.scenario(); }),
                             "a copy of the Scenario it plays")
      .def_property_readonly("time_s", exclusive(&World::time_s), "present time [s], 0 at the start")
      .def_property_readonly("utime", exclusive(&World::utime),
                             "present time on the frames' clock [us]: START_UTIME at the start")
      .def_property_readonly("frame_index", exclusive(&World::frame_index),
                             "number of the exposure that belongs to the present time: round(time_s * frame_rate_hz)")
      .def("command", exclusive(&World::command), "Command in effect from effective_time_s on; False if refused.",
           py::arg("robot"), py::arg("twist"), py::arg("effective_time_s"))
      .def("advance_to", exclusive_unlocked(&World::advance_to), py::arg("time_s"),
           "Moves everybody on to time_s [s]. A time in the past changes nothing.")
      .def("state", exclusive_unlocked(&World::state), py::arg("robot"),
           "UnicycleState of a robot now. IndexError on a name that the scenario does not have.")
      .def("command_in_effect", exclusive(&World::command_in_effect), py::arg("robot"), py::arg("time_s"),
           "Twist that acts at time_s [s], not in the past, if no other command comes before. IndexError on a name "
           "that the scenario does not have.")
      .def("true_cMo", exclusive([](const World& world, const std::string& robot) {
             const auto cMo = [&] {
               const py::gil_scoped_release unlocked;
               return world.true_cMo(robot);
             }();
             return to_array(cMo);
           }),
           "(4, 4): the leader's base in the robot's camera frame", py::arg("robot"))
      .def("latency_s", exclusive([](const World& world, const std::string& robot) { return world.latency_s(robot); }),
           py::arg("robot"),
           "From the exposure of the robot's present picture until the command that answers it acts [s]. IndexError: "
           "no such robot, or without a camera.")
      .def("true_relative_pose", exclusive([](const World& world, const std::string& robot) {
             const RelativePose pose = [&] {
               const py::gil_scoped_release unlocked;
               return world.true_relative_pose(robot);
             }();
             return std::make_tuple(pose.distance_m, pose.bearing_rad, pose.heading_rad);
           }),
           "(distance_m, bearing_rad, heading_rad) of the leader", py::arg("robot"))
      .def("ranges", exclusive_unlocked(&World::ranges), py::arg("robot"),
           "RangeScan of its range sensors, or None between two rounds. IndexError: no such robot, or without any.")
      .def("clearance_m", exclusive_unlocked(&World::clearance_m), py::arg("robot"),
           "From its outline to the nearest obstacle or other robot's outline [m]; below 0 they collide.")
      .def("leader_in_sight", exclusive_unlocked(&World::leader_in_sight), py::arg("robot"),
           "Whether a whole tag of its leader is turned to its camera and behind no obstacle and no other robot.")
      .def_property_readonly("obstacles", exclusive([](const World& world) { return world.obstacles(); }),
                             "list of Obstacle, a copy; also those drawn at random")
      .def("capture", exclusive_unlocked(&World::capture), "Frame, or None if this one is dropped.", py::arg("robot"));
}

void bind_loop_parts(py::module_& m) {
  py::class_<AwaitedAnswers>(m, "AwaitedAnswers", "The bookkeeping of lock-step: whose answer is still out.")
      .def(py::init<double, double>(), py::kw_only(), py::arg("resend_after_s"), py::arg("give_up_after_s"),
           "Asks again after resend_after_s [s] without an answer, gives up after give_up_after_s [s]; times are on "
           "any clock that only goes forward.")
      .def("sent", &AwaitedAnswers::sent, py::arg("robot"), py::arg("utime"), py::arg("now_s"),
           "A picture exposed at utime [us] went to the robot at now_s [s]: its answer is awaited.")
      .def("answered", &AwaitedAnswers::answered, "True if it answers the picture awaited.", py::arg("robot"),
           py::arg("utime"))
      .def_property_readonly("complete", &AwaitedAnswers::complete, "True if no answer is outstanding")
      .def("to_resend", &AwaitedAnswers::to_resend, py::arg("now_s"),
           "Names of the robots whose picture is to be sent once more at now_s [s]; the next time is resend_after_s "
           "later.")
      .def("overdue", &AwaitedAnswers::overdue, py::arg("now_s"),
           "Names of the robots that have been silent for too long at now_s [s].");
  m.def(
      "recording_header",
      [] {
        std::ostringstream csv;
        write_recording_header(csv);
        return csv.str();
      },
      "First line of what pilotfish-sim --record writes.");
  m.def(
      "recording_row",
      [](const World& world, const std::string& robot, const Twist& command, const std::string& status,
         bool delivered) {
        std::ostringstream csv;
        write_recording_row(csv, world, robot, {command, status, delivered});
        return csv.str();
      },
      "One row of it: the truth at this instant, and the answer.", py::arg("world"), py::arg("robot"), py::kw_only(),
      py::arg("command"), py::arg("status"), py::arg("delivered") = true, py::call_guard<py::gil_scoped_release>());
}

}  // namespace

PYBIND11_MODULE(sim, m) {
  py::module_::import("pilotfish.core");
  m.doc() = "The world to try it in: trajectories, unicycles, cameras. Seeded and without a clock.";
  bind_motion(m);
  bind_trajectories(m);
  bind_rendering(m);
  bind_obstacles(m);
  bind_scenario(m);
  bind_world(m);
  bind_loop_parts(m);

  make_value(m, "Pose2", {"x_m", "y_m", "heading_rad"});
  make_value(m, "Still");
  make_value(m, "Line", {"profile"});
  make_value(m, "Circle", {"radius_m", "clockwise", "profile"});
  make_value(m, "FigureEight", {"half_length_m", "half_width_m", "profile"});
  make_results<UnicycleState, RobotSpec>();
  add_reprs(m, {"UnicycleState", "Line", "Circle", "FigureEight", "CameraSpec", "RobotSpec"});
  add_repr(m, "World", {"time_s", "frame_index"});
}
