#pragma once

// The distance guard and the spacing, of every law, in Python.

#include "parameters.hpp"
#include "pilotfish/control/collision_guard.hpp"
#include "pilotfish/control/spacing.hpp"

namespace pilotfish::python {

inline void bind_guard(py::module_& m) {
  using namespace pilotfish::control;
  bind_parameters<SpacingConfig>(m, "SpacingConfig", "Spacing that grows with speed, for chains of robots.");
  bind_parameters<GuardConfig>(m, "GuardConfig", "The distance to the leader that no law may go below.");
  py::class_<Reaction>(m, "Reaction", "The drive: its limits, its lag, and how long a command acts.")
      .def(py::init([](const LimitsConfig& limits, double hold_s, double actuator_lag_s) {
             return Reaction{limits, hold_s, actuator_lag_s};
           }),
           py::kw_only(), py::arg("limits") = LimitsConfig{}, py::arg("hold_s") = 0.0, py::arg("actuator_lag_s") = 0.0,
           "limits: of the drive; hold_s: how long a command acts before the next one can [s]; actuator_lag_s: with "
           "which the wheels follow [s].");
  py::class_<Gap>(m, "Gap", "The gap to the leader when the command acts, if the leader brakes from the exposure on.")
      .def(py::init([](double distance_m, double bearing_rad, double distance_sigma_m, double own_mps, double set_mps,
                       double leaving_mps) {
             return Gap{distance_m, bearing_rad, distance_sigma_m, own_mps, set_mps, leaving_mps};
           }),
           py::kw_only(), py::arg("distance_m"), py::arg("bearing_rad") = 0.0, py::arg("distance_sigma_m") = 0.0,
           py::arg("own_mps") = 0.0, py::arg("set_mps") = 0.0, py::arg("leaving_mps") = 0.0,
           "distance_m [m] to where the leader was at the exposure, at bearing_rad [rad]; distance_sigma_m [m]: its "
           "standard deviation; own_mps [m/s]: the robot's real speed, as if it led to the leader; set_mps [m/s]: "
           "its drive's set value; leaving_mps [m/s]: the "
           "leader's speed away, negative if it comes.")
      .def_readwrite("distance_m", &Gap::distance_m, "to where the leader was at the exposure [m]")
      .def_readwrite("bearing_rad", &Gap::bearing_rad, "of that place [rad]")
      .def_readwrite("distance_sigma_m", &Gap::distance_sigma_m, "standard deviation of the distance [m]")
      .def_readwrite("own_mps", &Gap::own_mps, "the robot's real speed then, as if it led to the leader [m/s]")
      .def_readwrite("set_mps", &Gap::set_mps, "its drive's set value [m/s]")
      .def_readwrite("leaving_mps", &Gap::leaving_mps, "the leader's speed away [m/s]; negative: it comes");
  m.def("guarded_speed", &guarded_speed, py::arg("config"), py::arg("reaction"), py::arg("gap"),
        "Fastest speed [m/s] along the line of sight with which the robot can still keep d_min; negative: reverse.");
}

}  // namespace pilotfish::python
