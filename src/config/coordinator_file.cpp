#include <sstream>

#include "pilotfish/config/files.hpp"
#include "pilotfish/config/yaml_section.hpp"
#include "pilotfish/core/robot_name.hpp"

namespace pilotfish::config {
namespace {

void read_camera(YamlSection root, CoordinatorConfig& config) {
  config.camera = parse_calibration(root.file("calibration"));
  root.read_section("mounting", config.mounting);
  root.finish();
}

void read_law(YamlSection& parent, control::LawDescription& law) {
  if (!parent.optional(law.name)) return;
  YamlSection section = parent.section(law.name);
  for (control::LawParameter& each : law.parameters)
    if (section.optional(each.key)) each.value = section.number(each.key, each.min, each.max);
  section.finish();
}

void read_control(YamlSection root, control::FollowerConfig& config) {
  root.read_tree(config);
  for (control::LawDescription& law : config.laws) read_law(root, law);
  root.finish();
}

void read_alternatives(YamlSection root, CoordinatorConfig& config) {
  root.read(config.alternatives);
  if (root.optional("leaders"))
    for (YamlSection& section : root.sections("leaders")) {
      AlternativeLeader& other = config.other_leaders.emplace_back();
      other.leader = parse_leader_body(section.file("leader"));
      // The distance behind one robot is none behind another one, so it has no default in a file.
      if (!section.has("distance_m")) throw section.error("distance_m", "is missing");
      section.read(other);
      section.finish();
    }
  root.finish();
}

constexpr double kMinFrameRate_hz = 1.0, kMaxFrameRate_hz = 1000.0;

/// With a camera slower than measurements expire the robot stops in between: it needs a longer max_age_s, at less
/// speed. An age that is too short for any camera is the one at fault.
void check_frame_rate(const YamlSection& root, const CoordinatorFile& file) {
  const double max_age_s = file.coordinator.safety.max_age_s;
  if (file.frame_rate_hz * max_age_s >= kMinFramesPerMaxAge * (1.0 - 1e-9)) return;
  std::ostringstream problem;
  if (kMaxFrameRate_hz * max_age_s < kMinFramesPerMaxAge) {
    problem << max_age_s << " is too short: with frame_rate_hz " << file.frame_rate_hz << " at least "
            << kMinFramesPerMaxAge / file.frame_rate_hz << " s are needed, and at most 0.25 are allowed";
    throw root.error("safety.max_age_s", problem.str());
  }
  problem << file.frame_rate_hz << " is too slow: with safety.max_age_s " << max_age_s << " at least "
          << kMinFramesPerMaxAge / max_age_s << " Hz are needed. A slow camera may ask for safety.max_age_s up to 0.25 "
          << "together with control.limits.max_linear_mps and max_reverse_mps of at most " << kMaxBlindTravel_m
          << " m / max_age_s";
  throw root.error("frame_rate_hz", problem.str());
}

void check_black_box(const YamlSection& root, const BlackBoxConfig& config) {
  if (config.total_mb >= 2 * config.segment_mb) return;
  throw root.error("black_box.total_mb", std::to_string(config.total_mb) + " must hold two segments of " +
                                             std::to_string(config.segment_mb) + " MB at least");
}

/// What is chosen by name.
void read_names(YamlSection& root, CoordinatorFile& file) {
  control::FollowerConfig& control = file.coordinator.control;
  file.name = root.text("name");
  check_robot_name(file.name, "name");
  if (root.optional("source")) file.source = root.text("source");
  if (root.optional("odometry")) file.odometry = odometry_from(root.text("odometry"));
  if (root.optional("leader_intent_from"))
    file.leader_intent_from = leader_intent_from(root.text("leader_intent_from"));
  if (root.optional("publish_intent")) file.publish_intent = root.boolean("publish_intent");
  if (root.optional("key_file")) file.key_file = root.file_path("key_file").string();
  if (root.optional("law")) control::set_active_law(control, root.text("law"));
  if (root.optional("profile")) control.profile = control::profile_from(root.text("profile"));
}

}  // namespace

std::string leader_intent_from(const std::string& name) {
  if (name == "none") return "";
  check_robot_name(name, "leader_intent_from");
  return name;
}

Odometry odometry_from(std::string_view name) {
  if (name == "none") return Odometry::none;
  if (name == "pose") return Odometry::pose;
  throw ConfigError("odometry", "'" + std::string(name) + "' is not an odometry; choose none or pose");
}

void load_tuning(const std::filesystem::path& path, control::FollowerConfig& config) {
  parse_tuning(read_text_file(path), config);
}

void parse_tuning(const TextFile& text, control::FollowerConfig& config) {
  control::FollowerConfig tuned = config;  // all of it or nothing
  read_control(YamlSection::parse(text), tuned);
  config = std::move(tuned);
}

CoordinatorFile load_coordinator(const std::filesystem::path& path) { return parse_coordinator(read_text_file(path)); }

CoordinatorFile parse_coordinator(const TextFile& text) {
  YamlSection root = YamlSection::parse(text);
  CoordinatorFile file;
  CoordinatorConfig& config = file.coordinator;

  root.naming_file([&] { read_names(root, file); });
  if (root.optional("frame_rate_hz"))
    file.frame_rate_hz = root.number("frame_rate_hz", kMinFrameRate_hz, kMaxFrameRate_hz);
  config.control.velocity.control_period_s = 1.0 / file.frame_rate_hz;

  read_camera(root.section("camera"), config);
  config.leader = parse_leader_body(root.file("leader"));
  config.control.law = parse_fuzzy_controller(root.file("fuzzy"));
  root.read_section("setpoint", config.setpoint);
  root.read_section("vision", config.vision);
  if (root.optional("tuning")) parse_tuning(root.file("tuning"), config.control);
  if (root.optional("control")) read_control(root.section("control"), config.control);
  root.read_section("safety", config.safety);
  if (root.optional("alternatives")) read_alternatives(root.section("alternatives"), config);
  root.read_section("black_box", file.black_box);
  check_black_box(root, file.black_box);
  root.read_section("preview", file.preview);
  check_frame_rate(root, file);
  root.finish();
  return file;
}

}  // namespace pilotfish::config
