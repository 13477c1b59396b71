#pragma once

#include <limits>
#include <string>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// What a gate compared when it refused a tag or a pose, for the message beside the reason.
struct RefusedValue {
  const char* quantity = nullptr;  ///< e.g. "reprojection error"; nullptr: the reason has no number
  const char* unit = "";           ///< of the three numbers, e.g. "px"
  double value = 0.0;              ///< what was measured
  double min = -std::numeric_limits<double>::infinity();  ///< accepted from here, inclusive
  double max = std::numeric_limits<double>::infinity();   ///< up to here, inclusive

  explicit operator bool() const { return quantity != nullptr; }  ///< there is a number
};

/// A value that must not be higher.
inline RefusedValue at_most(const char* quantity, double value, double max, const char* unit = "") noexcept {
  return {quantity, unit, value, -std::numeric_limits<double>::infinity(), max};
}
/// A value that must not be lower.
inline RefusedValue at_least(const char* quantity, double value, double min, const char* unit = "") noexcept {
  return {quantity, unit, value, min, std::numeric_limits<double>::infinity()};
}

/// "reprojection error 7.1 px, at most 3 px", "range 31 m, accepted 0.05 to 20 m"; empty without a number.
std::string to_text(const RefusedValue& refused);

}  // namespace pilotfish
PILOTFISH_API_END
