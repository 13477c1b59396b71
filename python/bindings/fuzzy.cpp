#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <sstream>

#include "pilotfish/config/files.hpp"
#include "pilotfish/config/fuzzy_text.hpp"
#include "pilotfish/fuzzy/centroid.hpp"
#include "pilotfish/fuzzy/explain.hpp"
#include "repr.hpp"
#include "values.hpp"

namespace py = pybind11;
using namespace pilotfish::fuzzy;
using pilotfish::ConfigError;

namespace {

using DoubleArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

template <class... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream out;
  (out << ... << parts);
  return out.str();
}

// Sets and variables are checked where they are made, so that an ill-formed one cannot exist in Python. `name`: the key
// of a set's error, which belongs to no variable yet.
template <class Value>
Value checked(Value value, const char* name = "") {
  try {
    validate(value);
  } catch (const ValidationError& error) {
    throw ConfigError(error.where(), error.problem());
  } catch (const std::invalid_argument& error) {
    throw ConfigError(name, error.what());
  }
  return value;
}

RuleBase make_rules(const std::vector<std::vector<std::size_t>>& consequents) {
  RuleBase rules;
  rules.rows = consequents.size();
  rules.columns = consequents.empty() ? 0 : consequents.front().size();
  for (const auto& row : consequents) {
    if (row.size() != rules.columns) throw ConfigError("rules", "the rows have different lengths");
    rules.consequents.insert(rules.consequents.end(), row.begin(), row.end());
  }
  return rules;
}

// infer() relies on what validate() has shown. The attributes of a controller are read-only in Python and it is
// validated when it is made, so every Controller that Python can hold is a validated one.
Controller make_controller(const LinguisticVariable& error, const LinguisticVariable& error_change,
                           const LinguisticVariable& output, const RuleBase& rules, const std::string& name) {
  const py::gil_scoped_release released;
  return checked(Controller{name, error, error_change, output, rules});
}

py::ssize_t common_length(const DoubleArray& error, const DoubleArray& error_change) {
  if (error.ndim() != 1 || error_change.ndim() != 1 || error.shape(0) != error_change.shape(0))
    throw ConfigError("error_change",
                      "has not the shape (N,) of error: " + py::str(error_change.attr("shape")).cast<std::string>() +
                          " and " + py::str(error.attr("shape")).cast<std::string>());
  return error.shape(0);
}

std::pair<DoubleArray, DoubleArray> infer_batch(const Controller& controller, const DoubleArray& error,
                                                const DoubleArray& error_change, const InputWidths& widths) {
  const py::ssize_t count = common_length(error, error_change);
  DoubleArray output(count);
  DoubleArray strengths({count, static_cast<py::ssize_t>(kPaperRules)});
  const double *e = error.data(), *ec = error_change.data();
  double *u = output.mutable_data(), *strength = strengths.mutable_data();
  {
    py::gil_scoped_release release;
    for (py::ssize_t i = 0; i < count; ++i) {
      const Inference inference = infer(controller, e[i], ec[i], widths);
      u[i] = inference.output;
      strength = std::copy(inference.strengths.begin(), inference.strengths.end(), strength);
    }
  }
  return {output, strengths};
}

DoubleArray infer_outputs(const Controller& controller, const DoubleArray& error, const DoubleArray& error_change,
                          const InputWidths& widths) {
  const py::ssize_t count = common_length(error, error_change);
  DoubleArray output(count);
  const double *e = error.data(), *ec = error_change.data();
  double* u = output.mutable_data();
  {
    py::gil_scoped_release release;
    for (py::ssize_t i = 0; i < count; ++i) u[i] = infer_output(controller, e[i], ec[i], widths);
  }
  return output;
}

InputWidths make_widths(double error, double error_change, WidthShape shape) {
  for (const auto& [key, width] : {std::pair{"error", error}, std::pair{"error_change", error_change}})
    if (!(width >= 0.0) || std::isinf(width)) throw ConfigError(key, text("width ", width, " is outside [0, inf)"));
  return {error, error_change, shape};
}

void check_term_strengths(const LinguisticVariable& output, const std::vector<double>& term_strengths) {
  if (term_strengths.size() != output.terms.size())
    throw ConfigError("term_strengths",
                      text("one for each of the ", output.terms.size(), " terms, not ", term_strengths.size()));
  for (std::size_t i = 0; i < term_strengths.size(); ++i)
    if (!(term_strengths[i] >= 0.0 && term_strengths[i] <= 1.0))
      throw ConfigError("term_strengths." + output.terms[i].label, text(term_strengths[i], " is outside [0, 1]"));
}

py::array_t<double> polyline(const std::vector<std::array<double, 2>>& points) {
  py::array_t<double> result({static_cast<py::ssize_t>(points.size()), py::ssize_t{2}});
  double* next = result.mutable_data();
  for (const auto& point : points) next = std::copy(point.begin(), point.end(), next);
  return result;
}

Moments moments_of(const LinguisticVariable& output, const std::vector<double>& term_strengths) {
  check_term_strengths(output, term_strengths);
  return clipped_union_moments(output, term_strengths.data());
}

std::optional<Moments> ordered_moments_of(const LinguisticVariable& output, const std::vector<double>& term_strengths) {
  check_term_strengths(output, term_strengths);
  return ordered_union_moments(output, term_strengths.data());
}

}  // namespace

PYBIND11_MODULE(fuzzy, m) {
  m.doc() = "Fuzzy sets, linguistic variables, the 56-rule base, Mamdani inference and the exact centroid.";
  py::module_::import("pilotfish.core");  // its ConfigError

  py::class_<Triangle>(m, "Triangle", "mu(x) = max(0, min((x - a)/(b - a), (c - x)/(c - b)))")
      .def(py::init([](double a, double b, double c) {
             return checked(Triangle{a, b, c}, "Triangle");
           }),
           py::arg("a"), py::arg("b"), py::arg("c"), "ConfigError unless a <= b <= c with a < c, all finite.")
      .def_readonly("a", &Triangle::a, "left end of the support")
      .def_readonly("b", &Triangle::b, "where the degree is 1")
      .def_readonly("c", &Triangle::c, "right end of the support")
      .def("__repr__", [](const Triangle& s) { return text("Triangle(a=", s.a, ", b=", s.b, ", c=", s.c, ")"); });
  py::class_<Trapezoid>(
      m, "Trapezoid",
      "mu(x) = max(0, min((x - a)/(b - a), 1, (d - x)/(d - c))); open shoulders: a = b = -inf, c = d = inf")
      .def(py::init([](double a, double b, double c, double d) {
             return checked(Trapezoid{a, b, c, d}, "Trapezoid");
           }),
           py::arg("a"), py::arg("b"), py::arg("c"), py::arg("d"),
           "ConfigError unless a <= b <= c <= d; a = b = -inf or c = d = inf is an open shoulder.")
      .def_readonly("a", &Trapezoid::a, "left end of the support; -inf: open")
      .def_readonly("b", &Trapezoid::b, "from here the degree is 1; -inf: open")
      .def_readonly("c", &Trapezoid::c, "up to here the degree is 1; inf: open")
      .def_readonly("d", &Trapezoid::d, "right end of the support; inf: open")
      .def("__repr__",
           [](const Trapezoid& s) { return text("Trapezoid(a=", s.a, ", b=", s.b, ", c=", s.c, ", d=", s.d, ")"); });
  py::class_<Gaussian>(m, "Gaussian", "mu(x) = exp(-(x - mean)^2 / (2 sigma^2))")
      .def(py::init([](double mean, double sigma) {
             return checked(Gaussian{mean, sigma}, "Gaussian");
           }),
           py::arg("mean"), py::arg("sigma"), "ConfigError unless mean is finite and sigma positive.")
      .def_readonly("mean", &Gaussian::mean, "where the degree is 1")
      .def_readonly("sigma", &Gaussian::sigma, "width, in units of the universe")
      .def("__repr__", [](const Gaussian& s) { return text("Gaussian(mean=", s.mean, ", sigma=", s.sigma, ")"); });

  m.def(
      "membership",
      [](const MembershipFunction& set, const py::object& x) {
        return py::vectorize([&set](double value) { return membership(set, value); })(x);
      },
      "Degree of membership in [0, 1] of a number or of every element of an array.", py::arg("set"), py::arg("x"));
  m.def("support", &support, "The closed interval outside of which the degree is zero.", py::arg("set"));
  m.def(
      "level_cut",
      [](const MembershipFunction& set, double level) {
        if (!(level > 0.0 && level <= 1.0)) throw ConfigError("level", text(level, " is outside (0, 1]"));
        return level_cut(set, level);
      },
      "The interval {x : mu(x) >= level}.", py::arg("set"), py::arg("level"));

  py::class_<Term>(m, "Term", "A label and its fuzzy set.")
      .def(py::init([](const std::string& label, const MembershipFunction& set) {
             return Term{label, set};
           }),
           py::arg("label"), py::arg("set"),
           "label: e.g. NS; set: Triangle, Trapezoid or Gaussian over the variable's universe.")
      .def_readonly("label", &Term::label, "the word for it, e.g. NS")
      .def_readonly("set", &Term::set, "Triangle, Trapezoid or Gaussian")
      .def("__repr__", [](const Term& term) {
        return "Term('" + term.label + "', " + py::repr(py::cast(term.set)).cast<std::string>() + ")";
      });

  py::class_<LinguisticVariable>(m, "LinguisticVariable",
                                 "A name, a universe [min, max] and terms from negative to positive.")
      .def(py::init([](const std::string& name, const std::vector<Term>& terms, double min, double max) {
             return checked(LinguisticVariable{name, min, max, terms});
           }),
           py::arg("name"), py::arg("terms"), py::kw_only(), py::arg("min") = -1.0, py::arg("max") = 1.0,
           "terms from negative to positive; [min, max] is the universe. ConfigError names what is ill-formed.")
      .def_readonly("name", &LinguisticVariable::name, "name of the variable, e.g. E")
      .def_readonly("min", &LinguisticVariable::min, "lower end of the universe")
      .def_readonly("max", &LinguisticVariable::max, "upper end of the universe")
      .def_readonly("terms", &LinguisticVariable::terms, "list of Term from negative to positive, a copy")
      .def_property_readonly(
          "labels",
          [](const LinguisticVariable& variable) {
            std::vector<std::string> labels;
            for (const Term& term : variable.terms) labels.push_back(term.label);
            return labels;
          },
          "list of the terms' labels")
      .def("index_of", &LinguisticVariable::index_of, "Index of a label; ValueError listing those there are.",
           py::arg("label"));

  py::class_<RuleBase>(m, "RuleBase",
                       "Indices of output terms, one list for each row (term of E), one cell for each "
                       "column (term of EC).")
      .def(py::init(&make_rules), py::arg("consequents"),
           "consequents: one list of output terms' indices for each row. ConfigError if the rows have different "
           "lengths.")
      .def_readonly("rows", &RuleBase::rows, "number of terms of E")
      .def_readonly("columns", &RuleBase::columns, "number of terms of EC")
      .def_property_readonly(
          "consequents",
          [](const RuleBase& rules) {
            py::array_t<std::int64_t> table({rules.rows, rules.columns});
            std::copy(rules.consequents.begin(), rules.consequents.end(), table.mutable_data());
            return table;
          },
          "(rows, columns)")
      .def("__len__", &RuleBase::size);

  py::class_<Controller>(m, "Controller", "A two-input Mamdani controller; validated when it is made (ConfigError).")
      .def(py::init(&make_controller), py::kw_only(), py::arg("error"), py::arg("error_change"), py::arg("output"),
           py::arg("rules"), py::arg("name") = "",
           "error: E, error_change: EC, output: U; rules: RuleBase. ConfigError names the variable, term or cell at "
           "fault.")
      .def_readonly("name", &Controller::name, "name of the controller, for people")
      .def_readonly("error", &Controller::error, "LinguisticVariable E: the distance error")
      .def_readonly("error_change", &Controller::error_change,
                    "LinguisticVariable EC: its change over one control period")
      .def_readonly("output", &Controller::output, "LinguisticVariable U: the velocity")
      .def_readonly("rules", &Controller::rules, "RuleBase: the paper's Table I by default");

  py::enum_<WidthShape>(m, "WidthShape", "Shape of a fuzzified input: half-width or sigma is its width.")
      .value("triangle", WidthShape::triangle)
      .value("gaussian", WidthShape::gaussian);
  py::class_<InputWidths>(m, "InputWidths",
                          "Widths of the inputs A', B' of eq. (6), in units of their universes; 0 is a singleton.")
      .def(py::init(&make_widths), py::arg("error") = 0.0, py::arg("error_change") = 0.0,
           py::arg_v("shape", WidthShape::triangle, "WidthShape.triangle"),
           "ConfigError unless both widths are in [0, inf).")
      .def_readonly("error", &InputWidths::error, "width of A', in units of E's universe; 0: a singleton")
      .def_readonly("error_change", &InputWidths::error_change,
                    "width of B', in units of EC's universe; 0: a singleton")
      .def_readonly("shape", &InputWidths::shape, "WidthShape of both");

  py::class_<Inference>(m, "Inference", "What one inference says: output u*, and the strengths of the 56 rules.")
      .def_readonly("output", &Inference::output, "u*, eq. (7), inside the universe of U")
      .def_property_readonly(
          "strengths", [](const Inference& inference) { return DoubleArray(kPaperRules, inference.strengths.data()); },
          "(56,), row * 7 + column")
      .def("__repr__", [](const Inference& inference) { return text("Inference(output=", inference.output, ")"); });

  py::class_<Moments>(m, "Moments", "Area and first moment of a membership function.")
      .def_readonly("area", &Moments::area, "integral of mu(u) du over the universe")
      .def_readonly("first", &Moments::first, "integral of u mu(u) du; the centroid is first / area")
      .def("__repr__", [](const Moments& s) { return text("Moments(area=", s.area, ", first=", s.first, ")"); });

  m.def("describe_rule", &describe_rule, "\"IF E is NS AND EC is ZE THEN U is PM\"; rule = row * 7 + column.",
        py::arg("controller"), py::arg("rule"));
  m.def("infer", &infer, "Mamdani inference for one pair of inputs.", py::arg("controller"), py::arg("error"),
        py::arg("error_change"), py::arg_v("widths", InputWidths{}, "InputWidths()"));
  m.def("infer_batch", &infer_batch, "The same for arrays (N,): outputs (N,) and strengths (N, 56).",
        py::arg("controller"), py::arg("error"), py::arg("error_change"),
        py::arg_v("widths", InputWidths{}, "InputWidths()"));
  m.def("infer_outputs", &infer_outputs, "The outputs (N,) alone, the same bits, several times as fast.",
        py::arg("controller"), py::arg("error"), py::arg("error_change"),
        py::arg_v("widths", InputWidths{}, "InputWidths()"));
  m.def("clipped_union_moments", &moments_of,
        "Area and first moment of max_k min(term_strengths[k], mu_k(u)) over the universe of output.",
        py::arg("output"), py::arg("term_strengths"));
  m.def("ordered_union_moments", &ordered_moments_of,
        "The same as inference computes them, from polynomials in the term_strengths; None if the terms are Gaussians "
        "or out of "
        "order.",
        py::arg("output"), py::arg("term_strengths"));
  m.def(
      "possibility",
      [](const LinguisticVariable& variable, const std::string& label, double x, double width, WidthShape shape) {
        make_widths(width, 0.0, shape);
        return possibility(variable, variable.terms[variable.index_of(label)].set, variable.saturate(x), width, shape);
      },
      "sup min(A', term) of an input A' of this width around x, over the universe.", py::arg("variable"),
      py::arg("label"), py::arg("x"), py::arg("width"),
      py::arg_v("shape", WidthShape::triangle, "WidthShape.triangle"));
  py::class_<FiringRule>(m, "FiringRule", "A rule that fires, how strongly, and both in words.")
      .def_readonly("rule", &FiringRule::rule, "its number, row * columns + column")
      .def_readonly("strength", &FiringRule::strength, "its strength, eq. (4), in (0, 1]")
      .def_readonly("text", &FiringRule::text, "the rule and its strength in words")
      .def("__repr__", [](const FiringRule& firing) { return firing.text; });
  py::class_<Explanation>(m, "Explanation", "One inference with all that led to it.")
      .def_readonly("inference", &Explanation::inference, "Inference: output and all 56 strengths")
      .def_readonly("firing", &Explanation::firing, "rules with a strength above zero, strongest first")
      .def_property_readonly(
          "term_strengths",
          [](const Explanation& e) {
            return DoubleArray(static_cast<py::ssize_t>(e.term_strengths.size()), e.term_strengths.data());
          },
          "where each term of U is clipped")
      .def_property_readonly(
          "clipped", [](const Explanation& e) { return polyline(e.clipped); },
          "(N, 2): corners (u, mu) of the set whose centroid is the output");
  m.def("explain", &explain, "The inference, the rules that fire in words, and the clipped output set.",
        py::arg("controller"), py::arg("error"), py::arg("error_change"),
        py::arg_v("widths", InputWidths{}, "InputWidths()"), py::call_guard<py::gil_scoped_release>());
  m.def("to_fll", &pilotfish::config::to_fll, "The controller in fuzzylite's language, with every digit.",
        py::arg("controller"), py::call_guard<py::gil_scoped_release>());
  m.def("to_yaml", &pilotfish::config::to_yaml, "The controller in the form of data/fuzzy/*.yaml, with every digit.",
        py::arg("controller"), py::call_guard<py::gil_scoped_release>());
  m.def("load_controller", &pilotfish::config::load_fuzzy_controller,
        "Reads and validates data/fuzzy/*.yaml or fuzzylite's *.fll; ConfigError naming the key or the line.",
        py::arg("path"), py::call_guard<py::gil_scoped_release>());

  using pilotfish::python::make_value;
  make_value(m, "Triangle", {"a", "b", "c"});
  make_value(m, "Trapezoid", {"a", "b", "c", "d"});
  make_value(m, "Gaussian", {"mean", "sigma"});
  make_value(m, "Term", {"label", "set"});
  make_value(m, "LinguisticVariable", {"name", "terms", "min", "max"});
  make_value(m, "RuleBase", {"consequents"});
  make_value(m, "Controller", {"name", "error", "error_change", "output", "rules"});
  make_value(m, "InputWidths", {"error", "error_change", "shape"});
  pilotfish::python::make_results<Inference, Moments, FiringRule, Explanation>();
  using pilotfish::python::add_repr;
  add_repr(m, "LinguisticVariable", {"name", "min", "max", "labels"});
  add_repr(m, "RuleBase", {"rows", "columns"});
  add_repr(m, "Controller", {"name", "rules"});
  add_repr(m, "InputWidths");
  add_repr(m, "Explanation", {"inference", "firing"});
}
