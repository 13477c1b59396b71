#pragma once

// pilotfish.core.RangeScan.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "pilotfish/core/range_scan.hpp"

namespace pilotfish::python {

namespace py = pybind11;

inline void bind_range_scan(py::module_& m) {
  py::class_<RangeScan>(m, "RangeScan", "One scan of a laser, or one round of a ring of sonars.")
      .def(
          py::init([](std::int64_t utime, double first_rad, double step_rad, const std::vector<float>& ranges_m) {
            if (ranges_m.size() > kMaxRanges)
              throw py::value_error("a scan has at most " + std::to_string(kMaxRanges) + " readings, got " +
                                    std::to_string(ranges_m.size()));
            RangeScan scan{utime, first_rad, step_rad, {}};
            for (float range_m : ranges_m) scan.ranges_m.push_back(range_m);
            return scan;
          }),
          py::kw_only(), py::arg("utime"), py::arg("first_rad"), py::arg("step_rad"), py::arg("ranges_m"),
          "utime [us]; directions of the first reading and to the next [rad] in the base frame, positive: to the left; "
          "ranges_m: [m] from the base origin, below 0: no reading. ValueError on more than 1440.")
      .def_readonly("utime", &RangeScan::utime, "of the scan [us]")
      .def_readonly("first_rad", &RangeScan::first_rad, "direction of the first reading [rad]")
      .def_readonly("step_rad", &RangeScan::step_rad, "from one reading to the next [rad]")
      .def_property_readonly(
          "ranges_m",
          [](const RangeScan& scan) { return std::vector<float>(scan.ranges_m.begin(), scan.ranges_m.end()); },
          "list of float [m], a copy; below 0: no reading")
      .def_property_readonly("usable", &is_usable, "False: a coordinator would refuse it");
}

}  // namespace pilotfish::python
