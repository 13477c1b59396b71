#include "pilotfish/coordinator/coordinator.hpp"

#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "parameters.hpp"
#include "pilotfish/config/bundle.hpp"
#include "pilotfish/config/describe.hpp"
#include "pilotfish/config/files.hpp"

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
  py::class_<CoordinatorConfig> coordinator_config(m, "CoordinatorConfig", "Everything a coordinator needs to know.");
  coordinator_config.def(py::init<>())
      .def_readwrite("camera", &CoordinatorConfig::camera)
      .def_readwrite("mounting", &CoordinatorConfig::mounting)
      .def_readwrite("leader", &CoordinatorConfig::leader);
  bind_attributes(coordinator_config);  // vision, control, safety, setpoint
  bind_parameters<config::BlackBoxConfig>(m, "BlackBoxConfig", "Where and how much is recorded.");
  py::class_<config::CoordinatorFile>(m, "CoordinatorFile", "What pilotfish-coordinator --config reads.")
      .def_readonly("name", &config::CoordinatorFile::name)
      .def_readonly("source", &config::CoordinatorFile::source)
      .def_property_readonly(
          "odometry",
          [](const config::CoordinatorFile& file) { return file.odometry == config::Odometry::pose ? "pose" : "none"; })
      .def_readonly("key_file", &config::CoordinatorFile::key_file, "empty: nothing is authenticated")
      .def_readonly("announcements_from", &config::CoordinatorFile::announcements_from, "empty: nobody")
      .def_readonly("frame_rate_hz", &config::CoordinatorFile::frame_rate_hz)
      .def_readonly("black_box", &config::CoordinatorFile::black_box)
      .def_readwrite("coordinator", &config::CoordinatorFile::coordinator);
  using config::ConfigBundle, config::ConfigOverrides, config::ConfigText;
  py::class_<ConfigOverrides>(m, "ConfigOverrides", "What the command line says instead of the configuration.")
      .def(py::init([](std::optional<std::string> law, std::optional<std::string> profile,
                       std::optional<std::string> tuning) {
             return ConfigOverrides{std::move(law), std::move(profile), std::move(tuning)};
           }),
           py::kw_only(), py::arg("law") = py::none(), py::arg("profile") = py::none(), py::arg("tuning") = py::none())
      .def_readonly("law", &ConfigOverrides::law)
      .def_readonly("profile", &ConfigOverrides::profile)
      .def_readonly("tuning", &ConfigOverrides::tuning);
  py::class_<ConfigText>(m, "ConfigText", "A file that a coordinator was configured with.")
      .def(py::init([](std::string role, std::string name, const py::bytes& text) {
             return ConfigText{std::move(role), std::move(name), std::string(text)};
           }),
           py::kw_only(), py::arg("role"), py::arg("name"), py::arg("text"))
      .def_readonly("role", &ConfigText::role)
      .def_readonly("name", &ConfigText::name)
      .def_property_readonly("text", [](const ConfigText& file) { return py::bytes(file.text); });
  py::class_<ConfigBundle>(m, "ConfigBundle", "Everything a coordinator is configured with, as texts.")
      .def(py::init([](std::vector<ConfigText> files, ConfigOverrides overrides) {
             return ConfigBundle{std::move(files), std::move(overrides)};
           }),
           py::arg("files"), py::arg("overrides"))
      .def_readonly("files", &ConfigBundle::files)
      .def_readonly("overrides", &ConfigBundle::overrides);
  m.def("bundle_config", &config::bundle_config, py::arg("path"),
        py::arg_v("overrides", ConfigOverrides{}, "pilotfish.coordinator.ConfigOverrides()"));
  m.def("load_bundle", &config::load_bundle, py::arg("bundle"), "ValueError names the key at fault.");
  m.def("load_coordinator", &config::load_coordinator, py::arg("path"), "ValueError names the key at fault.");
  m.def(
      "load_tuning",
      [](const std::filesystem::path& path, control::FollowerConfig config) {
        config::load_tuning(path, config);
        return config;
      },
      py::arg("path"), py::arg("control"), "The control configuration with what the file says instead.");
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
      py::arg("tuning") = py::none(),
      "The control configuration with what the command line says instead (--law, --profile, --tuning). ValueError "
      "names "
      "the key at fault, and refuses a tuning whose sections the law does not read.");
  m.def("load_calibration", &config::load_calibration, py::arg("path"), "ViSP's camera XML or OpenCV's YAML.");
  m.def("load_leader_body", &config::load_leader_body, py::arg("path"));
  m.def("describe_config", &config::describe_config, "Every key of the coordinator's file as Markdown tables.");
}

}  // namespace

PYBIND11_MODULE(coordinator, m) {
  for (const char* room : {"pilotfish.core", "pilotfish.fuzzy", "pilotfish.vision", "pilotfish.control"})
    py::module_::import(room);
  m.doc() = "The heart: Coordinator.step(frame, now_us) -> StepResult. Pure: no clock, no I/O.";
  bind_config(m);

  py::class_<StepResult>(m, "StepResult", "What one frame led to.")
      .def_readonly("utime", &StepResult::utime)
      .def_readonly("status", &StepResult::status)
      .def_readonly("reason", &StepResult::reason)
      .def_readonly("observation", &StepResult::observation, "None unless measured in this very frame")
      .def_readonly("control", &StepResult::control, "None unless the law ran in this very frame")
      .def_readonly("command", &StepResult::command);

  py::class_<HeldCommand>(m, "HeldCommand", "The last command, until its measurement is too old.")
      .def(py::init([](std::int64_t utime, const Twist& command, std::int64_t from_us, std::int64_t until_us,
                       bool holding, bool run, bool ever_measured) {
             return HeldCommand{utime, command, {from_us}, {until_us}, holding, run, ever_measured};
           }),
           py::kw_only(), py::arg("utime"), py::arg("command"), py::arg("from_us"), py::arg("until_us"),
           py::arg("holding"), py::arg("run"), py::arg("ever_measured"))
      .def_readonly("command", &HeldCommand::command)
      .def_readonly("holding", &HeldCommand::holding)
      .def_readonly("utime", &HeldCommand::utime)
      .def_readonly("run", &HeldCommand::run)
      .def_readonly("ever_measured", &HeldCommand::ever_measured)
      .def(
          "at",
          [](const HeldCommand& held, std::int64_t now_us, Reason reason) {
            const HeldAnswer answer = held.at({now_us}, reason);
            return std::make_tuple(answer.status, answer.reason, answer.command);
          },
          "(status, reason, command) then, if that is missing.", py::arg("now_us"), py::arg("reason"))
      .def_property_readonly("from_us", [](const HeldCommand& held) { return held.from.us; })
      .def_property_readonly("until_us", [](const HeldCommand& held) { return held.until.us; });

  py::class_<Coordinator>(m, "Coordinator",
                          "Frame and its arrival in, StepResult out. now_us: monotonic; in a simulation, the simulated "
                          "time at which the frame arrives.")
      .def(py::init<const CoordinatorConfig&>(), py::arg("config"))
      .def(
          "step",
          [](Coordinator& coordinator, const Frame& frame, std::int64_t now_us) {
            return coordinator.step(frame, {now_us});
          },
          py::arg("frame"), py::arg("now_us"), py::call_guard<py::gil_scoped_release>(),
          "now_us: when the frame arrived, however long it waited for this call.")
      .def(
          "answer",
          [](Coordinator& coordinator, std::int64_t utime, const std::optional<Observation>& observation,
             std::int64_t now_us, Reason reason, std::int64_t known_age_us) {
            return coordinator.answer(utime, {observation, observation ? Reason::none : reason}, {now_us},
                                      known_age_us);
          },
          "step() without the eyes: what was seen in the frame of that time, or None and why.", py::arg("utime"),
          py::arg("observation"), py::arg("now_us"),
          py::arg_v("reason", Reason::no_tag_found, "pilotfish.core.Reason.no_tag_found"), py::arg("known_age_us") = 0)
      .def(
          "command_at",
          [](const Coordinator& coordinator, std::int64_t now_us, Reason reason) {
            return coordinator.command_at({now_us}, reason);
          },
          py::arg("now_us"), py::arg_v("reason", Reason::no_frame, "pilotfish.core.Reason.no_frame"),
          "What holds then if no newer frame has come; changes nothing.")
      .def_property_readonly("held", &Coordinator::held)
      .def_property_readonly("clock_epochs", &Coordinator::clock_epochs, "How often the source's clock was set.")
      .def("set_setpoint", &Coordinator::set_setpoint, py::arg("setpoint"),
           "False, and the old one stays, if a number is out of range or not finite.")
      .def("set_own_motion", &Coordinator::set_own_motion, py::arg("utime"), py::arg("twist"),
           "The own twist as odometry measured it; False if it cannot be used.")
      .def("set_announced_motion", &Coordinator::set_announced_motion, py::arg("utime"), py::arg("twist"),
           "The twist the leader announces of itself; False if it cannot be used.")
      .def_property(
          "memory",
          [](const Coordinator& coordinator) {
            const CoordinatorMemory memory = coordinator.memory();
            return std::make_pair(to_bytes(memory.decisions), to_bytes(memory.eyes));
          },
          [](Coordinator& coordinator, const std::pair<py::bytes, py::bytes>& memory) {
            if (!coordinator.set_memory({from_bytes(memory.first), from_bytes(memory.second)}))
              throw py::value_error("that is no memory of a coordinator of this program");
          },
          "(bytes, bytes): what its decisions and its eyes remember, for another one of the same configuration.")
      .def_property_readonly("setpoint", &Coordinator::setpoint)
      .def_property_readonly("rejected", &Coordinator::rejected);
}
