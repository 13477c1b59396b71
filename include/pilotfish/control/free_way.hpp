#pragma once

#include "pilotfish/api.hpp"
#include "pilotfish/control/range_field.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// How far a disc of radius_m around the base origin can move ahead along a circle of that curvature [1/m] (positive:
/// to the left, 0: straight) until it touches the point [m]; infinite: it never does on its first turn. A point inside
/// the disc is touched at once unless it is left behind.
double free_way_m(const SurfacePoint& point, double curvature, double radius_m) noexcept;

/// The same until it touches the first point of a view.
double free_way_m(const ObstacleView& view, double curvature, double radius_m) noexcept;

/// The same straight ahead after turning by direction_rad in place.
double free_way_towards_m(const ObstacleView& view, double direction_rad, double radius_m) noexcept;

}  // namespace pilotfish::control
PILOTFISH_API_END
