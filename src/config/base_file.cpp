#include "pilotfish/config/base_file.hpp"

#include <sstream>

#include "describe_tables.hpp"
#include "pilotfish/config/yaml_section.hpp"
#include "pilotfish/core/robot_name.hpp"

namespace pilotfish::config {
namespace {

template <class Config>
void read_section(YamlSection& parent, const std::string& key, Config& config) {
  if (!parent.optional(key)) return;
  YamlSection section = parent.section(key);
  section.read(config);
  section.finish();
}

}  // namespace

WheelDriver driver_from(const std::string& text) {
  using Kind = WheelDriver::Kind;
  if (text == "dry_run") return {Kind::dry_run, ""};
  if (text == "simulator") return {Kind::simulator, ""};
  const std::string prefix = "serial:";
  // A device is an absolute path: a relative one would depend on where the service was started.
  if (text.rfind(prefix + "/", 0) == 0) return {Kind::serial, text.substr(prefix.size())};
  throw ConfigError("driver", "'" + text + "' is not a driver; choose dry_run, simulator or serial:/dev/ttyUSB0");
}

BaseFile load_base(const std::filesystem::path& path) { return parse_base(read_text_file(path)); }

BaseFile parse_base(const TextFile& text) {
  YamlSection root = YamlSection::parse(text);
  BaseFile file;
  file.name = root.text("name");
  check_robot_name(file.name, "name");
  if (root.optional("driver")) file.driver = driver_from(root.text("driver"));
  if (root.optional("key_file")) file.key_file = root.file_path("key_file").string();
  root.read(file.base);
  read_section(root, "wheels", file.base.wheels);
  read_section(root, "limits", file.base.limits);
  read_section(root, "commands", file.base.commands);
  read_section(root, "serial", file.base.serial);
  root.finish();
  base::Base::check(file.base);
  if (file.driver.kind == WheelDriver::Kind::serial && !root.has("wheels"))
    throw root.error("wheels", "is missing: what turns real wheels must know their size");
  return file;
}

std::string describe_base_config() {
  std::ostringstream out;
  out << "# Configuration of the wheels' process\n\n"
         "Made by `pilotfish-base --describe-config` from the tables that read and check the file.\n"
         "Unknown keys are errors. Paths are relative to the file.\n\n"
         "## Top level\n\n| key | default | range | meaning |\n|---|---|---|---|\n"
         "| `name` | required | a name | the robot's name on the bus: letters, digits, underscores |\n"
         "| `driver` | dry_run | dry_run, simulator, serial:DEVICE | what turns the wheels |\n"
         "| `key_file` | none | file | 64 hex digits that only their owner may read: commands, and setpoints that "
         "resume, must carry "
         "a MAC made with this key |\n";
  describe<base::BaseConfig>(out);
  describe_section<base::DriveGeometry>(out, "wheels");
  describe_section<base::WheelLimitsConfig>(out, "limits");
  describe_section<base::CommandGuardConfig>(out, "commands");
  describe_section<base::SerialConfig>(out, "serial");
  return out.str();
}

}  // namespace pilotfish::config
