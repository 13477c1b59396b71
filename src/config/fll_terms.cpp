#include <cmath>
#include <limits>

#include "fll_lines.hpp"

namespace pilotfish::config {
namespace {

using fuzzy::MembershipFunction;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What the words after a term's label say. Where fuzzylite has an open end (a corner at infinity), both corners of that
// side are at infinity here.
MembershipFunction read_set(const FllLine& line, const std::string& label, const std::vector<std::string>& words) {
  const std::string& shape = words[1];
  const auto parameters = [&](std::size_t count) {
    std::vector<double> n;
    for (std::size_t i = 2; i < words.size(); ++i) n.push_back(fll_number(line, words[i]));
    if (n.size() == count + 1 && n.back() != 1.0)
      throw fll_error(line, "term '" + label + "': height " + words.back() + " is not supported; only 1");
    if (n.size() != count && n.size() != count + 1)
      throw fll_error(line, "term '" + label + "': " + shape + " needs " + std::to_string(count) + " numbers, got " +
                                std::to_string(n.size()));
    return n;
  };
  const auto trapezoid = [](double a, double b, double c, double d) -> MembershipFunction {
    return fuzzy::Trapezoid{a, a == -kInfinity ? -kInfinity : b, d == kInfinity ? kInfinity : c, d};
  };
  // Which way it goes: from the first number to the second.
  const auto rises = [&](const std::vector<double>& n) {
    if (n[0] == n[1]) throw fll_error(line, "term '" + label + "': a " + shape + " from a number to itself is zero");
    return n[0] < n[1];
  };
  if (shape == "Triangle") {
    const auto n = parameters(3);
    if (std::isinf(n[0]) || std::isinf(n[2])) return trapezoid(n[0], n[1], n[1], n[2]);
    return fuzzy::Triangle{n[0], n[1], n[2]};
  }
  if (shape == "Trapezoid") {
    const auto n = parameters(4);
    return trapezoid(n[0], n[1], n[2], n[3]);
  }
  if (shape == "Ramp") {  // 0 at the first number, 1 at the second and beyond it
    const auto n = parameters(2);
    return rises(n) ? trapezoid(n[0], n[1], kInfinity, kInfinity) : trapezoid(-kInfinity, -kInfinity, n[1], n[0]);
  }
  if (shape == "Rectangle") {
    const auto n = parameters(2);
    return trapezoid(n[0], n[0], n[1], n[1]);
  }
  if (shape == "Binary") {  // 1 from the start on, in the direction of the second number
    const auto n = parameters(2);
    return rises(n) ? trapezoid(n[0], n[0], kInfinity, kInfinity) : trapezoid(-kInfinity, -kInfinity, n[0], n[0]);
  }
  if (shape == "Gaussian") {
    const auto n = parameters(2);
    return fuzzy::Gaussian{n[0], n[1]};
  }
  throw fll_error(line, "term '" + label + "': " + shape +
                            " is not supported; Triangle, Trapezoid, Ramp, Rectangle, Binary and Gaussian are");
}

}  // namespace

fuzzy::Term fll_term(const FllLine& line) {
  const std::vector<std::string> words = fll_words(line.value);
  if (words.size() < 2) throw fll_error(line, "a term needs a name and a shape, got '" + line.value + "'");
  fuzzy::Term result{words[0], read_set(line, words[0], words)};
  try {
    fuzzy::validate(result.set);
  } catch (const std::invalid_argument& problem) {
    throw fll_error(line, "term '" + words[0] + "': " + problem.what());
  }
  return result;
}

}  // namespace pilotfish::config
