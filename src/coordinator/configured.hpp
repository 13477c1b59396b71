#pragma once

#include <vector>

#include "pilotfish/coordinator/coordinator.hpp"

// What a coordinator is made of, from its configuration, and what of that cannot work together.
namespace pilotfish {

/// The follower's part, with what the camera sees. Throws ConfigError if it sees no bearing at which a leader is
/// followed.
control::FollowerConfig with_view(const CoordinatorConfig& config);
/// One a leader; the alternatives' in their order. Throws ConfigError.
std::vector<vision::LeaderObserver> observers_of(const CoordinatorConfig& config);
/// In the same order.
std::vector<Setpoint> setpoints_of(const CoordinatorConfig& config);
/// Throws ConfigError naming the parameter.
void check(const CoordinatorConfig& config, const std::vector<vision::LeaderObserver>& observers);

}  // namespace pilotfish
