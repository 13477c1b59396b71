#include "config_options.hpp"

#include <CLI/CLI.hpp>
#include <iostream>

#include "pilotfish/core/robot_name.hpp"

namespace pilotfish::apps {

void add_config_options(CLI::App& app, ConfigOptions& options, const std::string& example) {
  auto* config = app.add_option("--config", options.config_path, "configuration, e.g. " + example);
  app.add_option("--name", options.name, "the robot's name on the bus, instead of the configuration's");
  app.add_option_function<std::string>(
         "--describe-config", [&options](const std::string& how) { options.describe_config = how; },
         "print every key of the configuration and end: as Markdown or, for editors, as a JSON schema")
      ->expected(0, 1)
      ->default_str("markdown")
      ->option_text("[markdown|json]")
      ->check(CLI::IsMember({"markdown", "json"}));
  app.callback([&options, config] {
    if (options.describe_config.empty() && config->count() == 0) throw CLI::RequiredError("--config");
  });
}

bool describes_config(const ConfigOptions& options, const std::function<std::string()>& as_markdown,
                      const std::function<std::string()>& as_json_schema) {
  if (options.describe_config.empty()) return false;
  std::cout << (options.describe_config == "json" ? as_json_schema() : as_markdown());
  return true;
}

void override_name(const ConfigOptions& options, std::string& name) {
  if (!options.name) return;
  check_robot_name(*options.name, "--name");
  name = *options.name;
}

}  // namespace pilotfish::apps
