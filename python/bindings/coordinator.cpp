#include "pilotfish/coordinator/coordinator.hpp"

#include <pybind11/stl/filesystem.h>

#include "arrays.hpp"
#include "parameters.hpp"
#include "pilotfish/config/describe.hpp"
#include "pilotfish/config/files.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::python;

namespace {

void bind_config(py::module_& m) {
  bind_parameters<SafetyConfig>(m, "SafetyConfig", "What must never happen, in numbers.");
  py::class_<CoordinatorConfig>(m, "CoordinatorConfig", "Everything a coordinator needs to know.")
      .def(py::init<>())
      .def_readwrite("camera", &CoordinatorConfig::camera)
      .def_readwrite("mounting", &CoordinatorConfig::mounting)
      .def_readwrite("leader", &CoordinatorConfig::leader)
      .def_readwrite("vision", &CoordinatorConfig::vision)
      .def_readwrite("control", &CoordinatorConfig::control)
      .def_readwrite("safety", &CoordinatorConfig::safety)
      .def_readwrite("setpoint", &CoordinatorConfig::setpoint);
  py::class_<config::CoordinatorFile>(m, "CoordinatorFile", "What pilotfish-coordinator --config reads.")
      .def_readonly("name", &config::CoordinatorFile::name)
      .def_readonly("source", &config::CoordinatorFile::source)
      .def_property_readonly(
          "odometry",
          [](const config::CoordinatorFile& file) { return file.odometry == config::Odometry::pose ? "pose" : "none"; })
      .def_readonly("key_file", &config::CoordinatorFile::key_file, "empty: nothing is authenticated")
      .def_readonly("announcements_from", &config::CoordinatorFile::announcements_from, "empty: nobody")
      .def_readonly("frame_rate_hz", &config::CoordinatorFile::frame_rate_hz)
      .def_readwrite("coordinator", &config::CoordinatorFile::coordinator);
  m.def("load_coordinator", &config::load_coordinator, py::arg("path"), "ValueError names the key at fault.");
  m.def(
      "load_tuning",
      [](const std::filesystem::path& path, control::FollowerConfig config) {
        config::load_tuning(path, config);
        return config;
      },
      py::arg("path"), py::arg("control"), "The control configuration with what the file says instead.");
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
      .def_readonly("command", &HeldCommand::command)
      .def_readonly("holding", &HeldCommand::holding)
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
      .def_property_readonly("setpoint", &Coordinator::setpoint)
      .def_property_readonly("rejected", &Coordinator::rejected);
}
