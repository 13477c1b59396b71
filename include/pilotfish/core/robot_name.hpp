#pragma once

#include <string>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// The one rule for a robot's name: 1 to 32 letters, digits and underscores. Channels, files and services are named
/// after it (robot1: ROBOT1_IMAGE), so it is one word everywhere. Throws ConfigError with `key` otherwise.
void check_robot_name(const std::string& name, const std::string& key);
/// The same name in capitals, as channels carry it: names that differ in nothing else are one robot on the bus.
std::string channel_word(const std::string& robot);

}  // namespace pilotfish
PILOTFISH_API_END
