#include "pilotfish/config/describe.hpp"

#include "description.hpp"
#include "pilotfish/config/base_file.hpp"
#include "pilotfish/config/files.hpp"
#include "pilotfish/coordinator/coordinator.hpp"

namespace pilotfish::config {
namespace {

constexpr const char* kRules =
    "Unknown keys are errors. An angle `x_rad` may be written `x_deg`. Paths are relative to the file.\n";

/// A list, with one such table an element.
SectionDescription alternative_leaders() {
  SectionDescription section{"alternatives.leaders[]",
                             "A list, in the order in which they are tried; at most " +
                                 std::to_string(kMaxLeaders - 1) + ". Who else may be followed.",
                             {}};
  section.keys.push_back(
      required_key("leader", "file: the tags that this one wears; of the first leader's family, with other ids"));
  describe_keys(section.keys, AlternativeLeader{});
  section.keys[1].required = true;
  return section;
}

ConfigDescription coordinator_description() {
  CoordinatorConfig defaults;
  SectionDescription top{"", "", {}};
  const std::vector<std::string> laws = control::law_names(defaults.control);
  KeyDescription frame_rate{"frame_rate_hz",
                            KeyDescription::Type::number,
                            "30",
                            1.0,
                            1000.0,
                            "frames per second expected of the source",
                            false,
                            {}};
  const KeyDescription publish_intent{
      "publish_intent",
      KeyDescription::Type::boolean,
      "false",
      0.0,
      0.0,
      "true: what it is about to drive is announced on NAME_MOTION, for robots that follow it",
      false,
      {}};
  top.keys = {
      required_key("name", "the robot's name on the bus: letters, digits, underscores"),
      text_key("source", "lcm", "where frames come from: camera:N, video:FILE, images:DIR, lcm[:CHANNEL], log:FILE"),
      frame_rate,
      text_key("odometry", "none", "the own twist: none (from the own commands), or pose (measured, on NAME_POSE)",
               {"none", "pose"}),
      text_key("leader_intent_from", "none",
               "the leader's name on the bus, to receive what it announces on LEADER_MOTION"),
      publish_intent,
      text_key(
          "key_file", "",
          "64 hex digits that only their owner may read: commands carry a MAC made with this key, and setpoints are "
          "accepted only with one"),
      text_key("law", "fuzzy", "fuzzy, or a baseline to compare it with", laws),
      text_key("profile", "anticipate", "how the fuzzy law drives: as published, or around a feed-forward",
               {"paper", "anticipate"}),
      text_key("tuning", "", "file: keys of `control`, as `pilotfish tune` writes them; those in `control` win"),
      required_key("camera.calibration", "file: OpenCV's calibration YAML or ViSP's camera XML"),
      required_key("leader", "file: the tags the leader wears"),
      required_key("fuzzy", "file: fuzzy sets and rules"),
  };
  ConfigDescription description = {top};
  describe_tree(description, "camera.mounting", defaults.mounting);
  describe_tree(description, "", defaults);
  description.push_back(alternative_leaders());
  for (const control::LawDescription& law : defaults.control.laws) describe_law(description, law);
  describe_tree(description, "black_box", BlackBoxConfig{});
  describe_tree(description, "preview", PreviewConfig{});
  return description;
}

ConfigDescription base_description() {
  const BaseFile defaults;
  SectionDescription top{"", "", {}};
  top.keys = {
      required_key("name", "the robot's name on the bus: letters, digits, underscores"),
      text_key("driver", "dry_run", "what turns the wheels: dry_run, simulator or serial:DEVICE"),
      text_key(
          "key_file", "",
          "64 hex digits that only their owner may read: commands, and setpoints that resume, must carry a MAC made "
          "with this key"),
  };
  describe_keys(top.keys, defaults.base);
  ConfigDescription description = {top};
  describe_tree(description, "", defaults.base);
  description.erase(description.begin() + 1);  // the base's own numbers stand at the top level
  return description;
}

}  // namespace

std::string describe_config() {
  ConfigDescription leader;
  describe_tree(leader, "tags", BodyTag{});
  return "# Configuration of a coordinator\n\n"
         "Made by `pilotfish-coordinator --describe-config` from the tables that read and check the file;\n"
         "`--describe-config=json` prints the same as a JSON schema.\n" +
         std::string(kRules) + as_markdown(coordinator_description()) +
         "\n# A leader's file\n\n"
         "`name`, `family` (tag36h11, ...) and a list `tags`; `id`, `size_m`, `position_m` and `facing_deg` of each "
         "are "
         "required.\n" +
         as_markdown(leader);
}

std::string describe_config_as_json_schema() {
  return as_json_schema("Configuration of a Pilotfish coordinator", coordinator_description());
}

std::string describe_base_config() {
  return "# Configuration of the wheels' process\n\n"
         "Made by `pilotfish-base --describe-config` from the tables that read and check the file;\n"
         "`--describe-config=json` prints the same as a JSON schema.\n" +
         std::string(kRules) + as_markdown(base_description());
}

std::string describe_base_config_as_json_schema() {
  return as_json_schema("Configuration of a Pilotfish base", base_description());
}

}  // namespace pilotfish::config
