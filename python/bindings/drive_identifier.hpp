#pragma once

#include <pybind11/pybind11.h>

#include "exclusive.hpp"
#include "pilotfish/control/drive_identifier.hpp"

namespace pilotfish::python {

/// DriveEstimate and DriveIdentifier of pilotfish.control.
inline void bind_drive_identifier(pybind11::module_& m) {
  namespace py = pybind11;
  using control::DriveEstimate;
  using control::DriveIdentifier;
  py::class_<DriveEstimate>(m, "DriveEstimate", "The delays of a drive, and how well they are known.")
      .def_readonly("latency_s", &DriveEstimate::latency_s,
                    "from the exposure to the moment the command for it reaches the wheels [s]")
      .def_readonly("actuator_lag_s", &DriveEstimate::actuator_lag_s, "time constant of the wheels' speed control [s]")
      .def_readonly("latency_sigma_s", &DriveEstimate::latency_sigma_s,
                    "standard deviation of its identification [s]; 0.1: not identifiable from the motion so far")
      .def_readonly("actuator_lag_sigma_s", &DriveEstimate::actuator_lag_sigma_s, "standard deviation [s]")
      .def_readonly("differs_from_settings", &DriveEstimate::differs_from_settings,
                    "the evidence against the configured delays is strong");
  py::class_<DriveIdentifier>(m, "DriveIdentifier",
                              "Identifies the drive's latency and lag from the own commands and from what is seen.")
      .def(py::init<const control::DriveModelConfig&, const control::LimitsConfig&>(), py::arg("drive"),
           py::arg("limits"), "The prior is around what is configured, broadly.")
      .def("command", exclusive(&DriveIdentifier::command), py::arg("twist"), py::arg("utime"),
           "The command for the picture exposed at utime [us]; by time.")
      .def("observe", exclusive(&DriveIdentifier::observe), py::arg("utime"), py::arg("distance_m"),
           py::arg("bearing_rad"), "The leader's place in the base frame, in the picture exposed at utime [us].")
      .def("interrupt", exclusive(&DriveIdentifier::interrupt), "The leader may be another one now.")
      .def_property_readonly("estimate", &DriveIdentifier::estimate, "DriveEstimate, a copy");
}

}  // namespace pilotfish::python
