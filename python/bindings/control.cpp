#include "parameters.hpp"
#include "pilotfish/control/follower.hpp"

namespace py = pybind11;
using namespace pilotfish;
using namespace pilotfish::control;
using namespace pilotfish::python;

PYBIND11_MODULE(control, m) {
  py::module_::import("pilotfish.core");
  py::module_::import("pilotfish.fuzzy");
  m.doc() = "From an observation to a twist: the fuzzy velocity law, the heading controller, the limits.";

  py::enum_<Profile>(m, "Profile", "Which law drives.")
      .value("paper", Profile::paper)
      .value("anticipate", Profile::anticipate);

  bind_parameters<FuzzyVelocityConfig>(m, "FuzzyVelocityConfig", "Physical meaning of the normalised universes.");
  bind_parameters<HeadingControllerConfig>(m, "HeadingControllerConfig", "Proportional heading controller.");
  bind_parameters<LimitsConfig>(m, "LimitsConfig", "Limits on speed, acceleration and turn rate.");

  py::class_<VelocityCommand>(m, "VelocityCommand", "One evaluation of the law with all it went through.")
      .def_readonly("linear_mps", &VelocityCommand::linear_mps)
      .def_readonly("error_m", &VelocityCommand::error_m, "e = d_p - d; positive: too close")
      .def_readonly("error_change_m", &VelocityCommand::error_change_m, "ec, per control period")
      .def_readonly("inference", &VelocityCommand::inference);

  py::class_<FollowerConfig>(m, "FollowerConfig", "Everything a Follower needs.")
      .def(py::init([](const fuzzy::Controller& law, Profile profile, const FuzzyVelocityConfig& velocity,
                       const HeadingControllerConfig& heading, const LimitsConfig& limits) {
             return FollowerConfig{profile, law, velocity, heading, limits};
           }),
           py::kw_only(), py::arg("law"), py::arg_v("profile", Profile::paper, "Profile.paper"),
           py::arg("velocity") = FuzzyVelocityConfig{}, py::arg("heading") = HeadingControllerConfig{},
           py::arg("limits") = LimitsConfig{})
      .def_readwrite("profile", &FollowerConfig::profile)
      .def_readwrite("law", &FollowerConfig::law)
      .def_readwrite("velocity", &FollowerConfig::velocity)
      .def_readwrite("heading", &FollowerConfig::heading)
      .def_readwrite("limits", &FollowerConfig::limits);

  py::class_<FollowerOutput>(m, "FollowerOutput", "The command and what the fuzzy law said on the way.")
      .def_readonly("command", &FollowerOutput::command)
      .def_readonly("velocity", &FollowerOutput::velocity);

  py::class_<Follower>(m, "Follower", "Observation in, Twist out; time comes from the observations.")
      .def(py::init<FollowerConfig>(), py::arg("config"))
      .def("follow", &Follower::follow, py::arg("observation"), py::arg("setpoint"))
      .def("restart", &Follower::restart, "Forget the past: the robot stands still.");

  m.def("heading_turn_rate", &heading_turn_rate, py::arg("config"), py::arg("bearing_rad"),
        py::arg("bearing_setpoint_rad"), "Turn rate [rad/s], positive to the left.");
  m.def("limit", &limit, py::arg("config"), py::arg("wanted"), py::arg("previous"), py::arg("dt_s"),
        "The nearest command to `wanted` within the limits.");
  m.def("fuzzy_velocity", &fuzzy_velocity, py::arg("controller"), py::arg("config"), py::arg("distance_setpoint_m"),
        py::arg("distance_m"), py::arg("previous_error_m"), py::arg("dt_s"), py::arg("distance_sigma_m") = 0.0,
        "The paper's law on one distance; previous_error_m may be None.");
}
