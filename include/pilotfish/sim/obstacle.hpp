#pragma once

#include <cstdint>
#include <vector>

#include "pilotfish/api.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/core/planar_motion.hpp"
#include "pilotfish/sim/robot_body.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::sim {

/// A cylinder that stands on the ground.
struct Obstacle {
  PILOTFISH_PARAMETERS(Obstacle);
  PILOTFISH_PARAMETER(double, x_m, 0.0, -1e4, 1e4, "in the world frame");
  PILOTFISH_PARAMETER(double, y_m, 0.0, -1e4, 1e4, "in the world frame");
  PILOTFISH_PARAMETER(double, radius_m, 0.15, 0.01, 10.0, "of the cylinder");
  PILOTFISH_PARAMETER(double, height_m, 0.5, 0.01, 10.0, "one lower than the line of sight hides no leader");
};

/// Obstacles that are drawn at random.
struct ObstacleField {
  PILOTFISH_PARAMETERS(ObstacleField);
  PILOTFISH_PARAMETER(int, seed, 0, 0, 2147483647, "of the places and sizes; 0: the scenario's");
  PILOTFISH_PARAMETER(int, count, 0, 0, 1000, "number of obstacles");
  PILOTFISH_PARAMETER(double, x_min_m, 0.0, -1e4, 1e4, "centres are not farther back");
  PILOTFISH_PARAMETER(double, x_max_m, 0.0, -1e4, 1e4, "and not farther ahead");
  PILOTFISH_PARAMETER(double, y_min_m, 0.0, -1e4, 1e4, "centres are not farther right");
  PILOTFISH_PARAMETER(double, y_max_m, 0.0, -1e4, 1e4, "and not farther left");
  PILOTFISH_PARAMETER(double, radius_min_m, 0.1, 0.01, 10.0, "of the smallest");
  PILOTFISH_PARAMETER(double, radius_max_m, 0.2, 0.01, 10.0, "of the greatest");
  PILOTFISH_PARAMETER(double, height_min_m, 0.5, 0.01, 10.0, "of the lowest");
  PILOTFISH_PARAMETER(double, height_max_m, 0.5, 0.01, 10.0, "of the highest");
  PILOTFISH_PARAMETER(double, clear_m, 0.5, 0.0, 100.0,
                      "no surface is nearer to where a robot starts, nor to the path of one that drives a trajectory");
  PILOTFISH_PARAMETER(double, gap_m, 0.0, 0.0, 100.0, "between the surfaces of two of them, at least");
};

/// Obstacles of a field around what is to stay clear. Throws ConfigError, key `obstacle_field.count`, if so many do not
/// fit. The same field and seed: the same obstacles.
std::vector<Obstacle> obstacles_of(const ObstacleField& field, std::uint64_t seed, const std::vector<Pose2>& clear,
                                   const std::vector<Obstacle>& others);

/// Its faces in its own frame, which stands on the ground in its middle: a prism whose sides touch the cylinder.
std::vector<Surface> surfaces_of(const Obstacle& obstacle);

/// Whether the straight line from one point to another, both in the world frame, meets the cylinder.
bool hides(const Obstacle& obstacle, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace pilotfish::sim
PILOTFISH_API_END
