#include "pilotfish/coordinator/coordinator.hpp"

#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "exclusive.hpp"
#include "law_exception.hpp"
#include "parameters.hpp"
#include "pilotfish/config/bundle.hpp"
#include "pilotfish/config/describe.hpp"
#include "pilotfish/config/files.hpp"
#include "pilotfish/coordinator/telemetry.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::python;

namespace {

py::bytes to_bytes(const Bytes& bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }
Bytes from_bytes(const py::bytes& bytes) {
  const std::string_view view = bytes;
  return {view.begin(), view.end()};
}

void bind_config(py::module_& m) {
  bind_parameters<SafetyConfig>(m, "SafetyConfig", "What must never happen, in numbers.");
  bind_parameters<AlternativeLeader>(m, "AlternativeLeader", "Another robot that may be followed, and how.")
      .def_readwrite("leader", &AlternativeLeader::leader, "LeaderBody: its tags");
  py::class_<CoordinatorConfig> coordinator_config(m, "CoordinatorConfig", "All settings of a coordinator.");
  coordinator_config.def(py::init<>(), "Defaults; camera and leader must be set. Coordinator() checks them.")
      .def_readwrite("camera", &CoordinatorConfig::camera, "CameraModel: size and lens of the coordinator's camera")
      .def_readwrite("mounting", &CoordinatorConfig::mounting, "CameraMounting: where it sits on the coordinator")
      .def_readwrite("leader", &CoordinatorConfig::leader, "LeaderBody: the tags to follow")
      .def_readwrite("other_leaders", &CoordinatorConfig::other_leaders,
                     "list of AlternativeLeader, a copy: who else may be followed, in the order of trying");
  bind_attributes(m, coordinator_config);  // vision, control, safety, setpoint
  bind_parameters<config::BlackBoxConfig>(m, "BlackBoxConfig", "Where and how much is recorded.");
  bind_parameters<config::PreviewConfig>(m, "PreviewConfig", "Small pictures for people on NAME_PREVIEW.");
  py::class_<config::CoordinatorFile>(m, "CoordinatorFile", "What pilotfish-coordinator --config reads.")
      .def_readonly("name", &config::CoordinatorFile::name, "the robot's name on the bus")
      .def_readonly("source", &config::CoordinatorFile::source,
                    "where frames come from, unless --source says otherwise")
      .def_property_readonly(
          "odometry",
          [](const config::CoordinatorFile& file) { return file.odometry == config::Odometry::pose ? "pose" : "none"; },
          "pose: own twist from NAME_POSE; none: nowhere")
      .def_readonly("key_file", &config::CoordinatorFile::key_file, "empty: nothing is authenticated")
      .def_readonly("leader_intent_from", &config::CoordinatorFile::leader_intent_from, "empty: disabled")
      .def_readonly("publish_intent", &config::CoordinatorFile::publish_intent,
                    "what it is about to drive is announced on NAME_MOTION")
      .def_readonly("frame_rate_hz", &config::CoordinatorFile::frame_rate_hz,
                    "rate expected of the source [Hz]; 1/T of the law unless control_period_s says otherwise")
      .def_readonly("black_box", &config::CoordinatorFile::black_box, "BlackBoxConfig: where and how much is recorded")
      .def_readonly("preview", &config::CoordinatorFile::preview, "PreviewConfig: pictures for people")
      .def_readwrite("coordinator", &config::CoordinatorFile::coordinator,
                     "CoordinatorConfig: what Coordinator() takes");
  using config::ConfigBundle, config::ConfigOverrides, config::ConfigText;
  py::class_<ConfigOverrides>(m, "ConfigOverrides", "What the command line says instead of the configuration.")
      .def(py::init([](std::optional<std::string> law, std::optional<std::string> profile,
                       std::optional<std::string> tuning) {
             return ConfigOverrides{std::move(law), std::move(profile), std::move(tuning)};
           }),
           py::kw_only(), py::arg("law") = py::none(), py::arg("profile") = py::none(), py::arg("tuning") = py::none(),
           "What is None is left as the configuration says.")
      .def_readonly("law", &ConfigOverrides::law, "name of the law, or None")
      .def_readonly("profile", &ConfigOverrides::profile, "name of the profile, or None")
      .def_readonly("tuning", &ConfigOverrides::tuning, "path of a tuning file, or None");
  py::class_<ConfigText>(m, "ConfigText", "A file that a coordinator was configured with.")
      .def(py::init([](std::string role, std::string name, const py::bytes& text) {
             return ConfigText{std::move(role), std::move(name), std::string(text)};
           }),
           py::kw_only(), py::arg("role"), py::arg("name"), py::arg("text"),
           "By keyword, as the attributes of the same name.")
      .def_readonly("role", &ConfigText::role,
                    "the key that names the file: config, camera.calibration, leader, fuzzy, tuning; --tuning")
      .def_readonly("name", &ConfigText::name, "where the file was")
      .def_property_readonly(
          "text", [](const ConfigText& file) { return py::bytes(file.text); }, "bytes: what it said");
  py::class_<ConfigBundle>(m, "ConfigBundle", "Everything a coordinator is configured with, as texts.")
      .def(py::init([](std::vector<ConfigText> files, ConfigOverrides overrides) {
             return ConfigBundle{std::move(files), std::move(overrides)};
           }),
           py::arg("files"), py::arg("overrides"), "files: list of ConfigText; overrides: ConfigOverrides.")
      .def_readonly("files", &ConfigBundle::files, "list of ConfigText, a copy")
      .def_readonly("overrides", &ConfigBundle::overrides, "ConfigOverrides of the command line");
  m.def("bundle_config", &config::bundle_config, py::arg("path"),
        py::arg_v("overrides", ConfigOverrides{}, "pilotfish.coordinator.ConfigOverrides()"),
        py::call_guard<py::gil_scoped_release>(),
        "The ConfigBundle of a configuration file that load_coordinator() takes. ValueError names the key at fault.");
  m.def("load_bundle", &config::load_bundle, py::arg("bundle"), py::call_guard<py::gil_scoped_release>(),
        "ValueError names the key at fault.");
  m.def("load_coordinator", &config::load_coordinator, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
        "ValueError names the key at fault.");
  m.def(
      "apply_overrides",
      [](control::FollowerConfig config, std::optional<std::string> law, std::optional<std::string> profile,
         const std::optional<std::filesystem::path>& tuning) {
        ConfigOverrides overrides{std::move(law), std::move(profile), std::nullopt};
        if (tuning) overrides.tuning = tuning->string();
        config::apply(overrides, config);
        return config;
      },
      py::arg("control"), py::kw_only(), py::arg("law") = py::none(), py::arg("profile") = py::none(),
      py::arg("tuning") = py::none(), py::call_guard<py::gil_scoped_release>(),
      "The control configuration with what the command line says instead (--law, --profile, --tuning). ValueError "
      "names "
      "the key at fault, and refuses a tuning whose sections the law does not read.");
  m.def("load_calibration", &config::load_calibration, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
        "ViSP's camera XML or OpenCV's YAML.");
  m.def("load_leader_body", &config::load_leader_body, py::arg("path"), py::call_guard<py::gil_scoped_release>(),
        "The LeaderBody of a leader file, see data/leaders. ValueError names the key at fault.");
  m.def("describe_config", &config::describe_config, py::call_guard<py::gil_scoped_release>(),
        "Every key of the coordinator's file as Markdown tables.");
}

}  // namespace

PYBIND11_MODULE(coordinator, m) {
  for (const char* module : {"pilotfish.core", "pilotfish.fuzzy", "pilotfish.vision", "pilotfish.control"})
    py::module_::import(module);
  m.doc() = "The coordinator: Coordinator.step(frame, now_us) -> StepResult. Pure: no clock, no I/O.";
  bind_config(m);

  py::class_<StepResult>(m, "StepResult", "What one frame led to.")
      .def_readonly("utime", &StepResult::utime, "exposure of the frame this answers [us]")
      .def_readonly("status", &StepResult::status, "Status of the coordinator")
      .def_readonly("reason", &StepResult::reason, "Reason for the status")
      .def_readonly("observation", &StepResult::observation, "None unless measured in this very frame")
      .def_readonly("control", &StepResult::control, "None unless the law ran in this very frame")
      .def_readonly("command", &StepResult::command, "Twist: what the wheels should do now")
      .def_readonly("leader_index", &StepResult::leader_index,
                    "who is followed: 0 the configured leader, 1 the first of other_leaders, ...")
      .def_readonly("leader_changes", &StepResult::leader_changes, "how often that has changed since the start");

  py::class_<TelemetryField>(m, "TelemetryField", "A field of what is reported of a frame.")
      .def_readonly("name", &TelemetryField::name, "with its unit, as in a line of pilotfish-coordinator --json")
      .def_readonly("unit", &TelemetryField::unit, "of the number, e.g. m/s; empty: it has none")
      .def_readonly("text", &TelemetryField::text, "what it is");
  m.def(
      "telemetry_fields", [] { return telemetry_fields(); },
      "list of TelemetryField: what is reported of a frame, in the order of a line of pilotfish-coordinator --json.");
  m.def(
      "step_values",
      [](const StepResult& result) {
        py::dict values;
        for (const TelemetryField& field : telemetry_fields()) values[field.name] = field.value(result, nullptr);
        return values;
      },
      py::arg("result"),
      "dict: the telemetry_fields() of a StepResult, as JSON would give them; None where nothing was measured, and "
      "for\n"
      "the latency, which a StepResult does not know.");

  py::class_<HeldCommand>(m, "HeldCommand", "The last command, until its measurement is too old.")
      .def(py::init([](std::int64_t utime, const Twist& command, std::int64_t from_us, std::int64_t until_us,
                       bool holding, bool run, bool ever_measured, bool turning) {
             return HeldCommand{utime, command, {from_us}, {until_us}, holding, run, ever_measured, turning};
           }),
           py::kw_only(), py::arg("utime"), py::arg("command"), py::arg("from_us"), py::arg("until_us"),
           py::arg("holding"), py::arg("run"), py::arg("ever_measured"), py::arg("turning") = false,
           "By keyword, as the attributes of the same name.")
      .def_readonly("command", &HeldCommand::command, "Twist of the last measurement; zero unless something is held")
      .def_readonly("holding", &HeldCommand::holding, "False: the wheels rest, whatever the time")
      .def_readonly("utime", &HeldCommand::utime, "exposure of the last frame that was in order [us]")
      .def_readonly("run", &HeldCommand::run, "the setpoint's")
      .def_readonly("turning", &HeldCommand::turning, "it is a turn in search of the leader")
      .def_readonly("ever_measured", &HeldCommand::ever_measured, "False: searching rather than lost")
      .def(
          "at",
          [](const HeldCommand& held, std::int64_t now_us, Reason reason) {
            const HeldAnswer answer = held.at({now_us}, reason);
            return std::make_tuple(answer.status, answer.reason, answer.command);
          },
          "(status, reason, command) then, if that is missing.", py::arg("now_us"), py::arg("reason"))
      .def_property_readonly(
          "from_us", [](const HeldCommand& held) { return held.from.us; },
          "the measurement's arrival [us], monotonic, inclusive")
      .def_property_readonly(
          "until_us", [](const HeldCommand& held) { return held.until.us; },
          "its exposure plus max_age [us], monotonic, inclusive");

  py::class_<Coordinator>(m, "Coordinator",
                          "Frame and its arrival in, StepResult out. now_us: monotonic; in a simulation, the simulated "
                          "time at which the frame arrives.")
      .def(py::init<const CoordinatorConfig&>(), py::arg("config"), py::call_guard<py::gil_scoped_release>(),
           "ConfigError (a ValueError) names the parameter that is out of range.")
      .def("step", exclusive([](Coordinator& coordinator, const Frame& frame, std::int64_t now_us) {
             return raising_law_exceptions([&] {
               const py::gil_scoped_release unlocked;
               return coordinator.step(frame, {now_us});
             });
           }),
           py::arg("frame"), py::arg("now_us"), "now_us: when the frame arrived, however long it waited for this call.")
      .def("step_observation",
           exclusive([](Coordinator& coordinator, std::int64_t utime, const std::optional<Observation>& observation,
                        std::int64_t now_us, Reason reason, std::int64_t known_age_us) {
             return raising_law_exceptions([&] {
               const py::gil_scoped_release unlocked;
               return coordinator.step_observation(utime, {observation, observation ? Reason::none : reason, {}},
                                                   {now_us}, known_age_us);
             });
           }),
           "step() without the vision: what was seen in the frame of that time, or None and why.", py::arg("utime"),
           py::arg("observation"), py::arg("now_us"),
           py::arg_v("reason", Reason::no_tag_found, "pilotfish.core.Reason.no_tag_found"), py::arg("known_age_us") = 0)
      .def("step_recorded",
           exclusive([](Coordinator& coordinator, std::int64_t utime, const std::optional<Observation>& observation,
                        std::uint32_t leaders_in_view, std::int64_t now_us, Reason reason, std::int64_t known_age_us) {
             LeadersSeen in_view{};
             for (std::size_t i = 0; i < in_view.size(); ++i) in_view[i] = (leaders_in_view >> i & 1U) != 0;
             return raising_law_exceptions([&] {
               const py::gil_scoped_release unlocked;
               return coordinator.step_recorded(utime, {observation, observation ? Reason::none : reason, {}}, in_view,
                                                {now_us}, known_age_us);
             });
           }),
           "step_observation() from a recording: of the leader that is followed after this frame; bit i of "
           "leaders_in_view: leader i was in view.",
           py::arg("utime"), py::arg("observation"), py::arg("leaders_in_view"), py::arg("now_us"),
           py::arg_v("reason", Reason::no_tag_found, "pilotfish.core.Reason.no_tag_found"), py::arg("known_age_us") = 0)
      .def("step_observations",
           exclusive([](Coordinator& coordinator, std::int64_t utime,
                        const std::vector<std::optional<Observation>>& observations, std::int64_t now_us,
                        std::int64_t known_age_us) {
             std::vector<vision::ObservationResult> seen;
             for (const std::optional<Observation>& each : observations)
               seen.push_back({each, each ? Reason::none : Reason::no_tag_found, {}});
             return raising_law_exceptions([&] {
               const py::gil_scoped_release unlocked;
               return coordinator.step_observations(utime, seen, {now_us}, known_age_us);
             });
           }),
           "step_observation() with one observation a leader, or None, in the order of their numbers.",
           py::arg("utime"), py::arg("observations"), py::arg("now_us"), py::arg("known_age_us") = 0)
      .def("command_at", exclusive([](const Coordinator& coordinator, std::int64_t now_us, Reason reason) {
             return coordinator.command_at({now_us}, reason);
           }),
           py::arg("now_us"), py::arg_v("reason", Reason::no_frame, "pilotfish.core.Reason.no_frame"),
           "What holds then if no newer frame has come; changes nothing.")
      .def_property_readonly("held", exclusive([](const Coordinator& c) { return c.held(); }),
                             "HeldCommand: the last command, until its measurement is too old")
      .def_property_readonly("clock_epochs", exclusive(&Coordinator::clock_epochs),
                             "How often the source's clock was set.")
      .def("set_setpoint", exclusive([](Coordinator& coordinator, const Setpoint& setpoint) {
             return raising_law_exceptions([&] { return coordinator.set_setpoint(setpoint); });
           }),
           py::arg("setpoint"), "False, and the old one stays, if a number is out of range or not finite.")
      .def("set_ego_motion", exclusive(&Coordinator::set_ego_motion), py::arg("utime"), py::arg("twist"),
           "The own twist as odometry measured it; False if it cannot be used.")
      .def("set_ranges", exclusive([](Coordinator& coordinator, const RangeScan& scan, std::int64_t now_us) {
             return coordinator.set_ranges(scan, {now_us});
           }),
           py::arg("scan"), py::arg("now_us"),
           "The RangeScan that arrived at now_us (monotonic); False if it cannot be used.")
      .def("set_leader_intent", exclusive(&Coordinator::set_leader_intent), py::arg("utime"), py::arg("twist"),
           "The twist the leader announces of itself; False if it cannot be used.")
      .def_property(
          "memory", exclusive([](const Coordinator& coordinator) {
            const CoordinatorMemory memory = coordinator.memory();
            return std::make_pair(to_bytes(memory.decisions), to_bytes(memory.vision));
          }),
          exclusive([](Coordinator& coordinator, const std::pair<py::bytes, py::bytes>& memory) {
            if (!coordinator.set_memory({from_bytes(memory.first), from_bytes(memory.second)}))
              throw py::value_error("that is no memory of a coordinator of this program");
          }),
          "(bytes, bytes): what its decisions and its vision remember, for another one of the same configuration.")
      .def_property_readonly("setpoint", exclusive([](const Coordinator& c) { return c.setpoint(); }),
                             "Setpoint that is kept")
      .def_property_readonly("leader_index", exclusive(&Coordinator::leader_index),
                             "who is followed: 0 the configured leader, 1 the first of other_leaders, ...")
      .def_property_readonly("leader_changes", exclusive(&Coordinator::leader_changes),
                             "how often that has changed since the start")
      .def_property_readonly("leader", exclusive([](const Coordinator& c) { return c.leader(); }),
                             "LeaderBody that is followed")
      .def_property_readonly("rejected", exclusive([](const Coordinator& c) { return c.rejected(); }),
                             "RejectionCounters of the observers since the start");

  make_value(m, "CoordinatorConfig");
  make_value(m, "ConfigOverrides", {"law", "profile", "tuning"});
  make_value(m, "ConfigText", {"role", "name", "text"});
  make_value(m, "ConfigBundle", {"files", "overrides"});
  make_value(m, "HeldCommand", {"utime", "command", "from_us", "until_us", "holding", "run", "ever_measured"});
  make_results<StepResult, config::CoordinatorFile>();
  add_reprs(m, {"ConfigOverrides", "ConfigText", "ConfigBundle", "CoordinatorFile", "StepResult", "HeldCommand",
                "TelemetryField"});
  add_repr(
      m, "CoordinatorConfig",
      {"camera", "mounting", "leader", "setpoint", "safety", "vision", "control", "alternatives", "other_leaders"});
}
