#pragma once

#include <functional>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace pilotfish::apps {

/// The command line options shared by the programs that read a configuration.
struct ConfigOptions {
  std::string config_path;
  std::optional<std::string> name;  ///< the robot's, instead of the configuration's
  std::string describe_config;      ///< how to print it: markdown, json; empty: not at all
};

/// Adds them; parsing requires --config unless the configuration is only to be described. `example`: of one.
void add_config_options(CLI::App& app, ConfigOptions& options, const std::string& example);

/// Answers --describe-config on stdout. False if that was not given.
bool describes_config(const ConfigOptions& options, const std::function<std::string()>& as_markdown,
                      const std::function<std::string()>& as_json_schema);

/// --name instead of `name`, if it is given. Throws ConfigError, key --name, if it is no robot's name.
void override_name(const ConfigOptions& options, std::string& name);

}  // namespace pilotfish::apps
