#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/control/avoidance.hpp"
#include "pilotfish/control/collision_guard.hpp"
#include "pilotfish/control/range_field.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// The fastest speed, of the sign of wanted.linear_mps and not above it, with which the robot can still stop before
/// what the ranges show in its path; 0 where they show nothing of the path because no reading looks there.
///
/// `view`: as seen from where the robot is when the command acts. `own`: its real twist then. `age_s`: of the ranges,
/// then.
double guarded_by_ranges(const AvoidanceConfig& config, const Reaction& reaction, const ObstacleView& view,
                         const Twist& wanted, const Twist& own, double age_s) noexcept;

}  // namespace pilotfish::control
PILOTFISH_API_END
