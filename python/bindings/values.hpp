#pragma once

// What Python expects of a value: ==, copy.copy, copy.deepcopy and pickle, made from the attributes that Python sees.
// A value that can be changed has no hash.

#include <pybind11/pybind11.h>

#include <algorithm>
#include <string>
#include <vector>

namespace pilotfish::python {

namespace py = pybind11;

/// Names of the public properties of a class, in the order of their definition; `settable`: those with a setter alone.
inline std::vector<std::string> properties_of(const py::handle& type, bool settable) {
  std::vector<std::string> names;
  const py::object property = py::module_::import("builtins").attr("property");
  for (const py::handle item : type.attr("__dict__").attr("items")()) {
    const auto [key, value] = item.cast<std::pair<std::string, py::object>>();
    if (key[0] != '_' && py::isinstance(value, property) && !(settable && value.attr("fset").is_none()))
      names.push_back(key);
  }
  return names;
}

inline bool are_equal(const py::object& a, const py::object& b) {
  if (!py::hasattr(a, "dtype")) return a.equal(b);
  return py::module_::import("numpy").attr("array_equal")(a, b).cast<bool>();
}

inline void give_method(const py::object& type, const char* name, const py::cpp_function& method) {
  type.attr(name) = method;
}

/// Which attributes make a value: those its constructor takes by keyword, and those that can be set. Asked for when
/// they are needed: an attribute may be bound later.
inline std::vector<std::string> with_settable(const py::handle& type, std::vector<std::string> constructed) {
  for (const std::string& name : properties_of(type, true))
    if (std::find(constructed.begin(), constructed.end(), name) == constructed.end()) constructed.push_back(name);
  return constructed;
}

/// Two of one class are equal if the attributes are that `names` says for it. NaN equals nothing.
template <class Names>
void add_equality(const py::object& type, const Names& names) {
  give_method(type, "__eq__",
              py::cpp_function(
                  [names](const py::object& self, const py::object& other) -> py::object {
                    const py::type its_type = py::type::of(self);
                    if (!its_type.is(py::type::of(other))) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
                    for (const std::string& name : names(its_type))
                      if (!are_equal(self.attr(name.c_str()), other.attr(name.c_str()))) return py::bool_(false);
                    return py::bool_(true);
                  },
                  py::name("__eq__"), py::is_method(type), py::arg("other"), "Of one class, with equal attributes."));
  type.attr("__hash__") = py::none();
}

/// Copies and pickles: made anew by the constructor from the attributes named `constructed`, then given all others that
/// can be set.
inline void add_copies(const py::object& type, const std::vector<std::string>& constructed = {}) {
  give_method(type, "__reduce__",
              py::cpp_function(
                  [constructed](const py::object& self) {
                    py::dict arguments, state;
                    const std::vector<std::string> names = with_settable(py::type::of(self), constructed);
                    for (std::size_t i = 0; i < names.size(); ++i)
                      (i < constructed.size() ? arguments : state)[names[i].c_str()] = self.attr(names[i].c_str());
                    // A partial, because __reduce__ knows no keywords; (None, state) is set attribute by attribute.
                    const py::object make =
                        py::module_::import("functools").attr("partial")(py::type::of(self), **arguments);
                    return py::make_tuple(make, py::tuple(), py::make_tuple(py::none(), state));
                  },
                  py::name("__reduce__"), py::is_method(type), "How copy and pickle make another one."));
}

/// Of an immutable value: it can be a key and a default of a dataclass. Of its numbers and texts alone,
/// which equal values share; lists and arrays do not count.
inline void add_hash(const py::object& type, const std::vector<std::string>& constructed) {
  give_method(type, "__hash__",
              py::cpp_function(
                  [constructed](const py::object& self) {
                    py::list scalars;
                    for (const std::string& name : constructed) {
                      const py::object value = self.attr(name.c_str());
                      if (py::isinstance<py::int_>(value) || py::isinstance<py::float_>(value) ||
                          py::isinstance<py::str>(value))
                        scalars.append(value);
                    }
                    return py::hash(py::tuple(scalars));
                  },
                  py::name("__hash__"), py::is_method(type), "Equal values have the same."));
}

/// A value that its constructor makes from the attributes named `constructed`, by keyword; the others are set.
inline void make_value(const py::object& type, const std::vector<std::string>& constructed = {}) {
  add_equality(type, [constructed](const py::handle& of) { return with_settable(of, constructed); });
  add_copies(type, constructed);
  if (!constructed.empty() && properties_of(type, true).empty()) add_hash(type, constructed);
}
inline void make_value(const py::module_& module, const char* name, const std::vector<std::string>& constructed = {}) {
  make_value(module.attr(name), constructed);
}

/// What only C++ makes: equal and copied, but not pickled.
template <class Value>
void make_result() {
  const py::object type = py::type::of<Value>();
  add_equality(type, [](const py::handle& of) { return properties_of(of, false); });
  const auto copied = [](const Value& self) { return Value(self); };
  give_method(type, "__copy__",
              py::cpp_function(copied, py::name("__copy__"), py::is_method(type), "A copy that shares nothing."));
  give_method(
      type, "__deepcopy__",
      py::cpp_function([copied](const Value& self, const py::dict&) { return copied(self); }, py::name("__deepcopy__"),
                       py::is_method(type), py::arg("memo"), "A copy that shares nothing."));
}

template <class... Values>
void make_results() {
  (make_result<Values>(), ...);
}

}  // namespace pilotfish::python
