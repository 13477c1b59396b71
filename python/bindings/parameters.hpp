#pragma once

// A config struct in Python, made from its one table of parameters: keyword-only constructor with the C++ defaults,
// attributes with the table's text and bounds as docstrings, a range check that raises ValueError, a readable repr.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <sstream>
#include <string>

#include "pilotfish/core/parameter.hpp"

namespace pilotfish::python {

namespace py = pybind11;

template <class Config>
void set_parameters(Config& config, const py::kwargs& values, const std::string& name) {
  py::object self = py::cast(&config, py::return_value_policy::reference);
  for (auto [key, value] : values) {
    if (!py::hasattr(self, key))
      throw py::type_error(name + " has no parameter '" + py::str(key).cast<std::string>() + "'");
    py::setattr(self, key, py::reinterpret_borrow<py::object>(value));
  }
}

template <class Config>
py::class_<Config> bind_parameters(py::module_& module, const char* name, const char* text) {
  py::class_<Config> binding(module, name, text);
  binding.def(py::init([name](const py::kwargs& values) {
    Config config;
    set_parameters(config, values, name);
    check_ranges(config, "");
    return config;
  }));
  for (const Parameter<Config>& parameter : Config::parameters()) {
    std::ostringstream doc;
    doc << parameter.text << " [" << parameter.min << ", " << parameter.max << "]";
    const std::string key(parameter.key);
    std::visit([&](auto member) { binding.def_readwrite(key.c_str(), member, doc.str().c_str()); }, parameter.member);
  }
  binding.def("__repr__", [name](const py::object& self) {
    std::string text_out = std::string(name) + "(";
    bool first = true;
    for (const Parameter<Config>& parameter : Config::parameters()) {
      if (!first) text_out += ", ";
      first = false;
      const std::string key(parameter.key);
      text_out += key + "=" + py::repr(self.attr(key.c_str())).cast<std::string>();
    }
    return text_out + ")";
  });
  return binding;
}

}  // namespace pilotfish::python
