#pragma once

// pilotfish.control: what the collision guard is given.

#include <pybind11/pybind11.h>

#include "pilotfish/control/collision_guard.hpp"

namespace pilotfish::python {

namespace py = pybind11;

inline void bind_gap(py::module_& m) {
  using namespace pilotfish::control;
  py::class_<Reaction>(m, "Reaction", "The drive: its limits, its lag, and how long a command acts.")
      .def(py::init([](const LimitsConfig& limits, double hold_s, double actuator_lag_s) {
             return Reaction{limits, hold_s, actuator_lag_s};
           }),
           py::kw_only(), py::arg("limits") = LimitsConfig{}, py::arg("hold_s") = 0.0, py::arg("actuator_lag_s") = 0.0,
           "limits: of the drive; hold_s: how long a command acts before the next one can [s]; actuator_lag_s: with "
           "which the wheels follow [s].");
  py::class_<Gap>(m, "Gap", "The gap to the leader when the command acts, if the leader brakes from the exposure on.")
      .def(py::init(
               [](double distance_m, double bearing_rad, double distance_sigma_m, double own_mps, double leaving_mps) {
                 return Gap{distance_m, bearing_rad, distance_sigma_m, own_mps, leaving_mps};
               }),
           py::kw_only(), py::arg("distance_m"), py::arg("bearing_rad") = 0.0, py::arg("distance_sigma_m") = 0.0,
           py::arg("own_mps") = 0.0, py::arg("leaving_mps") = 0.0,
           "distance_m [m] to where the leader was at the exposure, at bearing_rad [rad]; distance_sigma_m [m]: its "
           "standard deviation; own_mps [m/s]: the robot's real speed along the line of sight; leaving_mps [m/s]: the "
           "leader's speed away, negative if it comes.");
}

}  // namespace pilotfish::python
