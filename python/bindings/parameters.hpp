#pragma once

// A config struct in Python, made from its table of parameters and its list of sections: keyword-only constructor with
// the C++ defaults, attributes with the tables' texts and bounds as docstrings, a range check at every assignment that
// raises pilotfish.ConfigError, a readable repr, and what values.hpp gives.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <sstream>
#include <string>
#include <vector>

#include "pilotfish/core/sections.hpp"
#include "repr.hpp"
#include "values.hpp"

namespace pilotfish::python {

namespace py = pybind11;

/// Of a constructor, as text: pybind11 would show **kwargs. After the attributes are bound. `before` and `after`:
/// keywords that are neither in parameters() nor in sections(), as ", law: fuzzy.Controller".
template <class Config>
std::string keyword_signature(const std::string& before = "", const std::string& after = "") {
  std::string text = "__init__(self, *" + before;
  const py::object defaults = py::cast(Config{});
  const auto type_of = [](const py::object& value) {
    return py::str(py::type::of(value).attr("__name__")).cast<std::string>();
  };
  if constexpr (kHasParameters<Config>)
    for (const Parameter<Config>& parameter : Config::parameters()) {
      const std::string key(parameter.key);
      const py::object value = defaults.attr(key.c_str());
      const bool vector = py::isinstance<py::list>(value);
      text +=
          ", " + key + ": " + (vector ? "list[float]" : type_of(value)) + " = " + py::repr(value).cast<std::string>();
    }
  if constexpr (kHasSections<Config>)
    Config::sections([&](const std::string& name, auto) {
      if (name.empty()) return;
      const std::string type = type_of(defaults.attr(name.c_str()));
      text += ", " + name + ": " + type + " = ...";
    });
  return text + after +
         ") -> None\n\nConfigError (a ValueError) names a number out of its range, TypeError an unknown keyword.";
}

/// What can be set by name, in the order of the alphabet.
inline std::string attribute_names(const py::object& self) {
  std::string names;
  for (const auto& name : py::reinterpret_steal<py::list>(PyObject_Dir(py::type::of(self).ptr()))) {
    const py::object attribute = py::type::of(self).attr(name);
    if (!py::isinstance(attribute, py::module_::import("builtins").attr("property"))) continue;
    names += (names.empty() ? "" : ", ") + py::str(name).cast<std::string>();
  }
  return names;
}

inline void set_attributes(const py::object& self, const py::kwargs& values, const std::string& name) {
  for (auto [key, value] : values) {
    if (!py::hasattr(self, key))
      throw py::type_error(name + " has no parameter '" + py::str(key).cast<std::string>() +
                           "'; it has: " + attribute_names(self));
    py::setattr(self, key, py::reinterpret_borrow<py::object>(value));
  }
}

/// "TypeName: what the type says of itself".
template <class Part>
std::string describe_part() {
  const py::object type = py::type::of<Part>();
  return py::str(type.attr("__name__")).template cast<std::string>() + ": " +
         py::str(type.attr("__doc__")).template cast<std::string>();
}

/// A row of a table of parameters whose struct is forgotten: pybind11's code is then made once for each kind of value,
/// and not for each struct as well, which was most of what a module took to compile.
struct AnyParameter {
  const void* row;
  const void* (*value)(const py::object& self, const void* row);
  void (*assign)(const py::object& self, const void* row, const void* value);  ///< throws ConfigError, unchanged
};

template <class Config>
AnyParameter forget_struct(const Parameter<Config>& parameter) {
  using Row = Parameter<Config>;
  return {&parameter,
          [](const py::object& self, const void* row) {
            const Config& config = self.cast<const Config&>();
            return std::visit([&](auto member) -> const void* { return &(config.*member); },
                              static_cast<const Row*>(row)->member);
          },
          [](const py::object& self, const void* row, const void* value) {
            Config& config = self.cast<Config&>();
            Config changed = config;
            const Row& described = *static_cast<const Row*>(row);
            std::visit(
                [&](auto member) {
                  using Value = std::decay_t<decltype(config.*member)>;
                  changed.*member = *static_cast<const Value*>(value);
                },
                described.member);
            check_range(changed, described, "");
            config = changed;
          }};
}

/// What a parameter takes, for a message and for the type stubs.
template <class Value>
struct TypeOf;
template <>
struct TypeOf<double> {
  static constexpr const char *kText = "a number", *kPython = "typing.SupportsFloat | typing.SupportsIndex";
};
template <>
struct TypeOf<int> {
  static constexpr const char *kText = "a whole number", *kPython = "typing.SupportsInt | typing.SupportsIndex";
};
template <>
struct TypeOf<bool> {
  static constexpr const char *kText = "True or False", *kPython = "bool";
};
template <>
struct TypeOf<std::string> {
  static constexpr const char *kText = "a text", *kPython = "str";
};
template <>
struct TypeOf<Vector3> {
  static constexpr const char *kText = "a sequence of three numbers", *kPython = "typing.Sequence[float]";
};

template <class Value>
void bind_attribute(const py::object& type, const std::string& key, const AnyParameter& parameter,
                    const std::string& doc) {
  const py::cpp_function get(
      [parameter](const py::object& self) { return *static_cast<const Value*>(parameter.value(self, parameter.row)); },
      py::is_method(type));
  // Takes anything, to say by name what does not fit; the signature is for the type stubs.
  py::options options;
  options.disable_function_signatures();
  const std::string signature = std::string("(self: object, arg0: ") + TypeOf<Value>::kPython + ") -> None";
  const py::cpp_function set(
      [parameter, key](const py::object& self, const py::object& given) {
        py::detail::make_caster<Value> caster;
        if (!caster.load(given, true)) {
          const std::string name = py::str(py::type::of(self).attr("__name__"));
          throw py::type_error(name + "." + key + ": " + repr_of_field(given) + " is not " + TypeOf<Value>::kText);
        }
        const Value value = py::detail::cast_op<Value>(caster);
        parameter.assign(self, parameter.row, &value);
      },
      py::is_method(type), py::doc(signature.c_str()));
  type.attr(key.c_str()) = py::module_::import("builtins").attr("property")(get, set, py::none(), doc);
}

template <class Config>
py::class_<Config> bind_parameters(py::module_& module, const std::string& name, const char* text);

template <class Part, class = void>
struct PartText {
  static constexpr const char* kText = "A section of the configuration.";
};
template <class Part>
struct PartText<Part, std::void_t<decltype(Part::kText)>> : Part {};

/// A section's struct that no line has bound yet is bound here, under its own name and with its kText if it has one.
template <class Part>
void bind_part(py::module_& module) {
  if (py::detail::get_type_info(typeid(Part)) != nullptr) return;
  const std::string qualified = py::type_id<Part>();
  bind_parameters<Part>(module, qualified.substr(qualified.rfind(':') + 1), PartText<Part>::kText);
}

/// The attributes: numbers from parameters(), parts from sections(). A part whose keys stand in its parent's section
/// has no name there: bind it by hand.
template <class Config>
void bind_attributes(py::module_& module, py::class_<Config>& binding) {
  if constexpr (kHasParameters<Config>)
    for (const Parameter<Config>& parameter : Config::parameters())
      std::visit(
          [&](auto member) {
            using Value = std::decay_t<decltype(std::declval<Config>().*member)>;
            std::ostringstream doc;
            doc << parameter.text;
            if constexpr (!std::is_same_v<Value, bool> && !std::is_same_v<Value, std::string>)
              doc << " [" << parameter.min << ", " << parameter.max << "]";
            bind_attribute<Value>(binding, std::string(parameter.key), forget_struct(parameter), doc.str());
          },
          parameter.member);
  if constexpr (kHasSections<Config>)
    Config::sections([&](const std::string& name, auto member) {
      using Part = std::decay_t<decltype(std::declval<Config>().*member)>;
      if (name.empty()) return;
      bind_part<Part>(module);
      binding.def_readwrite(name.c_str(), member, describe_part<Part>().c_str());
    });
}

template <class Config>
py::class_<Config> bind_parameters(py::module_& module, const std::string& name, const char* text) {
  py::class_<Config> binding(module, name.c_str(), text);
  bind_attributes(module, binding);
  {
    py::options options;
    options.disable_function_signatures();
    binding.def(py::init([name](const py::args& positional, const py::kwargs& values) {
                  Config config;
                  if (!positional.empty())
                    throw py::type_error(name + " takes keywords only: " + attribute_names(py::cast(config)));
                  set_attributes(py::cast(&config, py::return_value_policy::reference), values, name);
                  return config;
                }),
                keyword_signature<Config>().c_str());
  }
  std::vector<std::string> fields;
  if constexpr (kHasParameters<Config>)
    for (const Parameter<Config>& parameter : Config::parameters()) fields.emplace_back(parameter.key);
  if constexpr (kHasSections<Config>)
    Config::sections([&](const std::string& part, auto) {
      if (!part.empty()) fields.push_back(part);
    });
  give_repr(binding, fields);
  make_value(binding);
  return binding;
}

}  // namespace pilotfish::python
