#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pilotfish/api.hpp"
#include "pilotfish/config/text_file.hpp"
#include "pilotfish/coordinator/coordinator.hpp"
#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/core/parameter.hpp"
#include "pilotfish/fuzzy/rule_base.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::config {

// Each load_x(path) is parse_x(read_text_file(path)).

/// ViSP's camera XML (vpXmlParserCamera) or OpenCV's calibration YAML (camera_matrix, distortion_coefficients,
/// image_width, image_height), distinguished by their content. Throws ConfigError.
CameraModel load_calibration(const std::filesystem::path& file);
CameraModel parse_calibration(const TextFile& file);

/// The tags of a leader; see data/leaders/. Throws ConfigError.
LeaderBody load_leader_body(const std::filesystem::path& file);
LeaderBody parse_leader_body(const TextFile& file);

/// Fuzzy sets and rules: our YAML (see data/fuzzy/) or, where the name ends in .fll, fuzzylite's FLL (see
/// fuzzy_text.hpp). Validated before it is returned. Throws ConfigError naming the variable, term, cell or line.
fuzzy::Controller load_fuzzy_controller(const std::filesystem::path& file);
fuzzy::Controller parse_fuzzy_controller(const TextFile& file);

/// The keys of the coordinator's section `control` as a file of their own, as `pilotfish tune` writes it; keys that are
/// not in it stay. Throws ConfigError, and then everything stays.
void load_tuning(const std::filesystem::path& file, control::FollowerConfig& config);
void parse_tuning(const TextFile& file, control::FollowerConfig& config);

/// Where the coordinator's own twist is measured.
enum class Odometry {
  none,  ///< nowhere: its commands are used
  pose,  ///< NAME_POSE, of which only speed and turn rate are used
};
/// Throws ConfigError listing the choices.
Odometry odometry_from(std::string_view name);

/// A leader's name on the bus; empty for "none". Throws ConfigError if it is no name.
std::string leader_intent_from(const std::string& name);

inline constexpr double kEveryPicture_hz = 1000.0;  ///< as BlackBoxConfig::picture_rate_hz: all of them

/// The ring of files with everything that a replay needs; see blackbox/black_box.hpp.
struct BlackBoxConfig {
  PILOTFISH_PARAMETERS(BlackBoxConfig);
  PILOTFISH_PARAMETER_WITHOUT_RANGE(std::string, directory, {},
                                    "folder for the recording, made if there is none; empty: nothing is recorded");
  PILOTFISH_PARAMETER(int, total_mb, 1000, 2, 1'000'000,
                      "size of all files of this robot; beyond, the oldest are deleted");
  PILOTFISH_PARAMETER(int, segment_mb, 50, 1, 1000, "size of one file");
  PILOTFISH_PARAMETER(double, picture_rate_hz, 2.0, 0.0, kEveryPicture_hz,
                      "rate at which raw pictures are kept, as JPEG; 1000: every one, however fast they come. Images "
                      "received as JPEG are all kept");
  PILOTFISH_PARAMETER_WITHOUT_RANGE(bool, raw_pictures, false,
                                    "raw pictures are kept as they are, not as JPEG, so that a replay can repeat the "
                                    "vision: 9 MB/s at 640 x 480, 30 Hz");
  PILOTFISH_PARAMETER(double, max_age_h, 0.0, 0.0, 1e6,
                      "files last written longer ago are deleted, by the computer's clock; 0: only their size counts");
};

/// Small pictures for people on NAME_PREVIEW, where the camera's own are not on the bus.
struct PreviewConfig {
  PILOTFISH_PARAMETERS(PreviewConfig);
  PILOTFISH_PARAMETER(double, rate_hz, 5.0, 0.0, 60.0, "at most so many a second; 0: none");
  PILOTFISH_PARAMETER(int, max_width_px, 640, 80, 16384, "wider pictures are made smaller, by a whole factor");
  PILOTFISH_PARAMETER(int, jpeg_quality, 60, 10, 100, "of the JPEG: 60 makes 25 kB of 640 x 480");
};

/// What `pilotfish-coordinator --config` reads: the coordinator's configuration plus what the program around it needs.
struct CoordinatorFile {
  std::string name = "robot1";         ///< the robot's name on the bus
  std::string source = "lcm";          ///< where frames come from, unless --source says otherwise
  Odometry odometry = Odometry::none;  ///< where the own twist is measured
  std::string leader_intent_from;      ///< the leader's name on the bus, to receive LEADER_MOTION; empty: none
  bool publish_intent = false;         ///< what it is about to drive is announced on NAME_MOTION
  std::string key_file;                ///< for bus::load_key(); empty: commands and setpoints are not authenticated
  double frame_rate_hz = 30.0;    ///< expected of the source; 1/T of the law unless control_period_s says otherwise
  BlackBoxConfig black_box;       ///< where and how much is recorded
  PreviewConfig preview;          ///< pictures for people
  CoordinatorConfig coordinator;  ///< what Coordinator() takes
};
/// Throws ConfigError naming the key.
CoordinatorFile load_coordinator(const std::filesystem::path& file);
CoordinatorFile parse_coordinator(const TextFile& file);

}  // namespace pilotfish::config
PILOTFISH_API_END
