#pragma once

// A readable repr for the values of a module: Name(field=value, ...), made from the attributes that Python sees.

#include <pybind11/pybind11.h>

#include <initializer_list>
#include <string>
#include <vector>

namespace pilotfish::python {

namespace py = pybind11;

/// A large array as its shape, anything else as Python writes it.
inline std::string repr_of_field(const py::object& value) {
  if (!py::hasattr(value, "dtype") || value.attr("size").cast<std::size_t>() <= 8)
    return py::repr(value).cast<std::string>();
  return "<" + py::str(value.attr("shape")).cast<std::string>() + " array>";
}

/// "Name(field=value, ...)".
inline std::string repr_of(const py::object& self, const std::vector<std::string>& fields) {
  std::string text = py::str(py::type::of(self).attr("__name__")).cast<std::string>() + "(";
  for (std::size_t i = 0; i < fields.size(); ++i)
    text += (i > 0 ? ", " : "") + fields[i] + "=" + repr_of_field(self.attr(fields[i].c_str()));
  return text + ")";
}

inline void give_repr(const py::object& type, const std::vector<std::string>& fields) {
  type.attr("__repr__") = py::cpp_function([fields](const py::object& self) { return repr_of(self, fields); },
                                           py::name("__repr__"), py::is_method(type));
}

/// Gives the class `name` of the module a repr of these fields; without any, of all its public properties.
inline void add_repr(const py::module_& module, const char* name, std::initializer_list<const char*> fields = {}) {
  const py::object type = module.attr(name);
  std::vector<std::string> names(fields.begin(), fields.end());
  if (names.empty()) {
    const py::object property = py::module_::import("builtins").attr("property");
    for (const py::handle item : type.attr("__dict__").attr("items")()) {
      const auto [key, value] = item.cast<std::pair<std::string, py::object>>();
      if (key[0] != '_' && py::isinstance(value, property)) names.push_back(key);
    }
  }
  give_repr(type, names);
}

/// The same for several classes, each with all its properties.
inline void add_reprs(const py::module_& module, std::initializer_list<const char*> names) {
  for (const char* name : names) add_repr(module, name);
}

}  // namespace pilotfish::python
