#include "pilotfish/config/describe.hpp"

#include <sstream>

#include "describe_tables.hpp"
#include "pilotfish/config/files.hpp"
#include "pilotfish/coordinator/coordinator.hpp"

namespace pilotfish::config {

std::string describe_config() {
  std::ostringstream out;
  out << "# Configuration of a coordinator\n\n"
         "Made by `pilotfish-coordinator --describe-config` from the tables that read and check the file.\n"
         "Unknown keys are errors. An angle `x_rad` may be written `x_deg`. Paths are relative to the file.\n\n"
         "## Top level\n\n| key | default | meaning |\n|---|---|---|\n"
         "| `name` | required | the robot's name on the bus: letters, digits, underscores |\n"
         "| `source` | lcm | where frames come from: camera:N, video:FILE, images:DIR, lcm[:CHANNEL], log:FILE |\n"
         "| `frame_rate_hz` | 30 | frames per second expected of the source, 1 to 1000 |\n"
         "| `odometry` | none | the own twist: none (from the own commands), or pose (measured, on NAME_POSE) |\n"
         "| `announcements_from` | none | the leader's name on the bus, to hear what it announces on LEADER_MOTION |\n"
         "| `key_file` | none | 64 hex digits that only their owner may read: commands carry a MAC made with this key, "
         "and "
         "setpoints are believed only with one |\n"
         "| `law` | fuzzy | fuzzy, or a peer to compare it with: pbvs (ViSP's visual servo), pid |\n"
         "| `profile` | anticipate | how the fuzzy law drives: paper (as published) or anticipate |\n"
         "| `tuning` | none | file: keys of `control`, as `pilotfish tune` writes them; those in `control` win |\n"
         "| `camera.calibration` | required | file: OpenCV's calibration YAML or ViSP's camera XML |\n"
         "| `leader` | required | file: the tags the leader wears |\n"
         "| `fuzzy` | required | file: fuzzy sets and rules |\n";
  describe_section<CameraMounting>(out, "camera.mounting");
  describe_section<Setpoint>(out, "setpoint");
  describe_section<vision::LeaderObserverConfig, vision::TagDetectorConfig, vision::TagGates, vision::LeaderPoseConfig>(
      out, "vision");
  describe_section<vision::HeadingFilterConfig>(out, "vision.heading");
  describe_section<vision::LeaderTrackConfig>(out, "vision.track");
  describe_section<control::FuzzyVelocityConfig>(out, "control.velocity");
  describe_section<control::HeadingControllerConfig>(out, "control.heading");
  describe_section<control::LimitsConfig>(out, "control.limits");
  describe_section<control::AnticipateConfig>(out, "control.anticipate");
  describe_section<control::LeaderMotionConfig>(out, "control.leader_motion");
  describe_section<control::DriveModelConfig>(out, "control.drive");
  describe_section<control::AnnouncementConfig>(out, "control.announcement");
  describe_section<control::PbvsConfig>(out, "control.pbvs");
  describe_section<control::PidConfig>(out, "control.pid");
  describe_section<SafetyConfig>(out, "safety");
  describe_section<BlackBoxConfig>(out, "black_box");
  out << "\n# A leader's file\n\n"
         "`name`, `family` (tag36h11, ...) and a list `tags`; `id`, `size_m`, `position_m` and `facing_deg` of each "
         "are "
         "required.\n";
  describe_section<BodyTag>(out, "tags");
  return out.str();
}

}  // namespace pilotfish::config
