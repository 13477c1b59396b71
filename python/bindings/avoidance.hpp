#pragma once

// pilotfish.control: obstacles.

#include "parameters.hpp"
#include "pilotfish/control/follower.hpp"
#include "pilotfish/control/free_way.hpp"
#include "pilotfish/control/range_guard.hpp"

namespace pilotfish::python {

inline void bind_avoidance(py::module_& m) {
  using namespace pilotfish::control;
  bind_parameters<AvoidanceConfig>(m, "AvoidanceConfig", "Obstacles, as sonars or a laser measure them.");
  bind_parameters<SearchConfig>(m, "SearchConfig", "A leader that is lost is searched by turning in place.");
  py::class_<AvoidanceOutput>(m, "AvoidanceOutput", "What was made of the ranges in one step.")
      .def_readonly("bearing_shift_rad", &AvoidanceOutput::bearing_shift_rad,
                    "of the bearing that is kept [rad]; positive: the robot drives farther to the left")
      .def_readonly("free_way_m", &AvoidanceOutput::free_way_m,
                    "in the direction in which the law alone would drive [m]")
      .def_readonly("free_direction_rad", &AvoidanceOutput::free_direction_rad,
                    "that was chosen, in the base frame [rad]")
      .def_readonly("nearest_m", &AvoidanceOutput::nearest_m, "from the robot's circle to the nearest surface [m]")
      .def_readonly("allowed_mps", &AvoidanceOutput::allowed_mps,
                    "forward speed with which it can stop before what the ranges show in its path [m/s]")
      .def_readonly("backing_off", &AvoidanceOutput::backing_off, "it was blocked, and makes room to turn")
      .def_readonly("limited", &AvoidanceOutput::limited, "that was below what the law wanted");
  m.def("avoidance_rules", &avoidance_rules, "fuzzy.Controller: the 56 rules by which obstacles are passed.");
  m.def(
      "free_way_m",
      [](double x_m, double y_m, double curvature, double radius_m) {
        return free_way_m(SurfacePoint{x_m, y_m}, curvature, radius_m);
      },
      py::arg("x_m"), py::arg("y_m"), py::kw_only(), py::arg("curvature"), py::arg("radius_m"),
      "How far a disc of radius_m around the base origin can move ahead along a circle of that curvature [1/m] until "
      "it "
      "touches the point [m]; inf: never.");
  m.def(
      "guarded_by_ranges",
      [](const AvoidanceConfig& config, const LimitsConfig& limits, double hold_s, double actuator_lag_s,
         const RangeScan& scan, const Twist& wanted, const Twist& own) {
        RangeField field;
        field.add(scan, own, scan.utime);
        return guarded_by_ranges(config, {limits, hold_s, actuator_lag_s},
                                 field.view(reading_model(config), scan.utime), wanted, own, 0.0);
      },
      py::arg("config"), py::arg("limits"), py::kw_only(), py::arg("hold_s"), py::arg("actuator_lag_s"),
      py::arg("scan"), py::arg("wanted"), py::arg("own"),
      "Fastest forward speed [m/s], not above wanted's, with which the robot can stop before what the scan shows in "
      "its "
      "path.");
}

}  // namespace pilotfish::python
