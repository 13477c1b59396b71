#pragma once

#include <filesystem>
#include <string>

#include "pilotfish/api.hpp"
#include "pilotfish/base/base.hpp"
#include "pilotfish/config/text_file.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::config {

/// The wheel driver.
struct WheelDriver {
  /// The kinds of wheel drivers.
  enum class Kind {
    dry_run,    ///< none: the wheels' command is only published
    simulator,  ///< pilotfish-sim, which receives NAME_BASE
    serial,     ///< a motor controller on a serial line
  };
  Kind kind = Kind::dry_run;  ///< which of them
  std::string device;         ///< of serial, e.g. /dev/ttyUSB0
};
/// "dry_run", "simulator" or "serial:/dev/ttyUSB0". Throws ConfigError (key "driver") listing them.
WheelDriver driver_from(const std::string& text);

/// What `pilotfish-base --config` reads.
struct BaseFile {
  std::string name = "robot1";  ///< the robot's name on the bus
  WheelDriver driver;           ///< the wheel driver
  std::string key_file;         ///< for bus::load_key(); empty: commands and setpoints are not authenticated
  base::BaseConfig base;        ///< limits, wheels, guards
};
/// Throws ConfigError naming the key.
BaseFile load_base(const std::filesystem::path& file);
BaseFile parse_base(const TextFile& file);

/// Every key of that file as Markdown: docs/base-configuration.md.
std::string describe_base_config();
std::string describe_base_config_as_json_schema();

}  // namespace pilotfish::config
PILOTFISH_API_END
