#pragma once

// A law written in Python, and how it is made.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "law_exception.hpp"
#include "pilotfish/control/law.hpp"

namespace pilotfish::python {

namespace py = pybind11;
using control::Law, control::LawDescription, control::LawParameter, control::LimitsConfig;

using LawValues = std::map<std::string, double>;

inline LawValues values_of(const LawDescription& law) {
  LawValues values;
  for (const LawParameter& each : law.parameters) values[each.key] = each.value;
  return values;
}

/// A law written in Python: an object with follow(observation, setpoint, dt_s) -> Twist and, if it remembers anything,
/// restart(). What it raises is printed, and the robot stands still; what is meant to end the program waits for the way
/// back to Python.
class PythonLaw final : public Law {
 public:
  explicit PythonLaw(py::object law) : law_(std::move(law)) {}
  ~PythonLaw() override {
    const py::gil_scoped_acquire gil;
    law_ = py::object();
  }
  Twist follow(const Observation& observation, const Setpoint& setpoint, double dt_s) noexcept override {
    const py::gil_scoped_acquire gil;
    try {
      const py::object twist = law_.attr("follow")(observation, setpoint, dt_s);
      if (py::isinstance<Twist>(twist)) return twist.cast<Twist>();
      PyErr_Format(PyExc_TypeError, "follow() of a law returned %.200s instead of a pilotfish.core.Twist",
                   Py_TYPE(twist.ptr())->tp_name);
      throw py::error_already_set();
    } catch (py::error_already_set& error) {
      settle(error, "follow() of a law");
    }
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone};
  }
  void restart() noexcept override {
    const py::gil_scoped_acquire gil;
    try {
      if (py::hasattr(law_, "restart")) law_.attr("restart")();
    } catch (py::error_already_set& error) {
      settle(error, "restart() of a law");
    }
  }

 private:
  static void settle(py::error_already_set& error, const char* where) {
    if (!keep_law_exception(error)) error.discard_as_unraisable(where);
  }

  py::object law_;
};

/// A function that is kept and copied where Python's lock is not held: in configurations.
inline std::shared_ptr<py::function> shared(py::function function) {
  return {new py::function(std::move(function)), [](py::function* kept) {
            const py::gil_scoped_acquire gil;
            delete kept;
          }};
}

/// How a law written in Python is made: make({parameter: value}, limits).
struct PythonMaker {
  std::string name;
  std::shared_ptr<py::function> make;  ///< see shared()
  std::unique_ptr<Law> operator()(const std::vector<LawParameter>& values, const LimitsConfig& limits) const {
    const py::gil_scoped_acquire gil;
    py::object law = (*make)(values_of({name, "", values, nullptr}), limits);
    if (PyCallable_Check(py::object(py::getattr(law, "follow", py::none())).ptr()) == 0)
      throw ConfigError("control." + name,
                        "make() returned " + py::repr(law).cast<std::string>() + ", which has no method follow()");
    return std::make_unique<PythonLaw>(std::move(law));
  }
};

}  // namespace pilotfish::python
