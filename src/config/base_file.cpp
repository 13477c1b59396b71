#include "pilotfish/config/base_file.hpp"

#include "pilotfish/config/yaml_section.hpp"
#include "pilotfish/core/robot_name.hpp"

namespace pilotfish::config {
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
  root.naming_file([&] { check_robot_name(file.name, "name"); });
  if (root.optional("driver")) file.driver = root.naming_file([&] { return driver_from(root.text("driver")); });
  if (root.optional("key_file")) file.key_file = root.file_path("key_file").string();
  root.read_tree(file.base);
  root.finish();
  root.naming_file([&] { base::Base::check(file.base); });
  if (file.driver.kind == WheelDriver::Kind::serial && !root.has("wheels"))
    throw root.error("wheels", "is missing: what turns real wheels must know their size");
  return file;
}

}  // namespace pilotfish::config
