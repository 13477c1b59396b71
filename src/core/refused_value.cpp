#include "pilotfish/core/refused_value.hpp"

#include <cmath>
#include <cstdio>

namespace pilotfish {
namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

}  // namespace

std::string to_text(const RefusedValue& refused) {
  if (!refused) return {};
  const std::string unit = *refused.unit == '\0' ? "" : std::string(" ") + refused.unit;
  std::string text = refused.quantity + (" " + number(refused.value)) + unit;
  const bool from = std::isfinite(refused.min), to = std::isfinite(refused.max);
  if (from && to) return text + ", accepted " + number(refused.min) + " to " + number(refused.max) + unit;
  if (from) return text + ", at least " + number(refused.min) + unit;
  if (to) return text + ", at most " + number(refused.max) + unit;
  return text;
}

}  // namespace pilotfish
