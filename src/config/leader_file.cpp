#include "pilotfish/config/files.hpp"
#include "pilotfish/config/yaml_section.hpp"

namespace pilotfish::config {

LeaderBody load_leader_body(const std::filesystem::path& file) { return parse_leader_body(read_text_file(file)); }

LeaderBody parse_leader_body(const TextFile& file) {
  YamlSection root = YamlSection::parse(file);
  LeaderBody body;
  body.name = root.text("name");
  body.family = root.text("family");
  for (YamlSection& section : root.sections("tags")) {
    BodyTag tag;
    // Without these a tag would silently be somewhere else, so they have no default in a file.
    for (const char* key : {"id", "size_m", "position_m"})
      if (!section.has(key)) throw section.error(key, "is missing");
    if (!section.has_angle("facing_rad")) throw section.error("facing_deg", "is missing");
    section.read(tag);
    section.finish();
    body.tags.push_back(tag);
  }
  root.finish();
  root.naming_file([&] { body.validate(); });
  return body;
}

}  // namespace pilotfish::config
