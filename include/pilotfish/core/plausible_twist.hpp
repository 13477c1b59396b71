#pragma once

#include <cmath>

#include "pilotfish/api.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// No robot that follows or is followed indoors is faster, in either direction: a greater twist was damaged, forged
/// or written in other units. The one bound for every twist received from outside; limits of this robot are
/// configuration.
inline constexpr Twist kMaxPlausibleTwist{10.0, 50.0};

/// Within that bound, and finite: not a number is not within a bound either.
inline bool is_plausible(const Twist& twist) {
  return std::abs(twist.linear_mps) <= kMaxPlausibleTwist.linear_mps &&
         std::abs(twist.angular_radps) <= kMaxPlausibleTwist.angular_radps;
}

}  // namespace pilotfish
PILOTFISH_API_END
