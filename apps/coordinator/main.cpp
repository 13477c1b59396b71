// pilotfish-coordinator: the onboard program. Reads the configuration, opens the bus and the source, hands both to the
// control loop. Nothing is opened before the configuration is known to be good.

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <iostream>
#include <memory>

#include "control_loop.hpp"
#include "exit_codes.hpp"
#include "frame_feed.hpp"
#include "options.hpp"
#include "pilotfish/bus/log_reader.hpp"
#include "pilotfish/capture/frame_source.hpp"
#include "pilotfish/config/describe.hpp"
#include "pilotfish/config/files.hpp"
#include "pilotfish/core/angles.hpp"
#include "stop_signal.hpp"

namespace pilotfish::apps {
namespace {

constexpr double kStopDistance_m = 0.40;

config::CoordinatorFile load(const Options& options) {
  config::CoordinatorFile file = config::load_coordinator(options.config_path);
  if (options.name) file.name = *options.name;
  if (options.source) file.source = *options.source;
  try {
    parse_source(file.source);
  } catch (const std::invalid_argument& error) {
    throw ConfigError("source", error.what());
  }
  if (options.tuning) config::load_tuning(*options.tuning, file.coordinator.control);
  if (options.odometry) file.odometry = config::odometry_from(*options.odometry);
  if (options.announcements_from) file.announcements_from = config::announcements_from(*options.announcements_from);
  if (options.law) file.coordinator.control.active_law = control::law_from(*options.law);
  if (options.profile) file.coordinator.control.profile = control::profile_from(*options.profile);
  return file;
}

/// Prints what will be used, so that a log shows what drove the robot.
void announce(const config::CoordinatorFile& file, const bus::Bus& bus) {
  const CoordinatorConfig& config = file.coordinator;
  spdlog::info("robot {}: law {}, profile {}, keep {:.2f} m at {:.1f} deg{}", file.name,
               to_string(config.control.active_law), to_string(config.control.profile), config.setpoint.distance_m,
               degrees(config.setpoint.bearing_rad), config.setpoint.run ? "" : " (told to stop)");
  spdlog::info("camera {} x {} px, f = {:.1f} px{}", config.camera.width, config.camera.height, config.camera.fx,
               config.camera.has_distortion() ? ", with distortion" : "");
  std::string ids;
  for (const BodyTag& tag : config.leader.tags) ids += " " + std::to_string(tag.id);
  spdlog::info("leader {}: {} with tags{}", config.leader.name, config.leader.family, ids);
  spdlog::info("fuzzy law {}: {} rules; limits {:.2f} m/s, {:.2f} m/s2, {:.2f} rad/s", config.control.law.name,
               config.control.law.rules.size(), config.control.limits.max_linear_mps,
               config.control.limits.max_linear_acceleration_mps2, config.control.limits.max_angular_radps);
  if (file.odometry == config::Odometry::pose)
    spdlog::info("own motion: odometry on {}", bus::channel(file.name, "POSE"));
  if (!file.announcements_from.empty())
    spdlog::info("announcements of the leader on {}", bus::channel(file.announcements_from, "MOTION"));
  spdlog::info("bus {} (receive buffer {} bytes)", bus.url(), bus.receive_buffer_bytes());
}

struct OpenedFeed {
  std::unique_ptr<FrameFeed> feed;
  std::string description;
  bool every_frame = false;
};

OpenedFeed open_feed(const config::CoordinatorFile& file, bus::Bus& bus) {
  using Kind = SourceSpec::Kind;
  const SourceSpec spec = parse_source(file.source);
  const std::string image_channel = bus::channel(file.name, "IMAGE");
  const auto pull = [](const std::shared_ptr<capture::FrameSource>& source) {
    return OpenedFeed{pull_feed([source] { return source->next(); }), source->describe(), true};
  };
  switch (spec.kind) {
    case Kind::camera: {
      const auto open = [index = std::stoi(spec.argument), camera = file.coordinator.camera,
                         rate = file.frame_rate_hz] {
        return capture::open_camera(index, camera.width, camera.height, rate);
      };
      auto source = open();
      const std::string description = source->describe();
      return {camera_feed(std::move(source), open), description, false};
    }
    case Kind::video: return pull(capture::open_video(spec.argument));
    case Kind::images: return pull(capture::open_images(spec.argument, file.frame_rate_hz));
    case Kind::log: {
      auto reader = std::make_shared<bus::LogReader>(spec.argument, image_channel);
      return {pull_feed([reader] { return reader->next(); }), image_channel + " in " + spec.argument, true};
    }
    case Kind::lcm: break;
  }
  const std::string channel = spec.argument.empty() ? image_channel : spec.argument;
  return {bus_feed(bus, channel), "LCM channel " + channel, false};
}

void log_to(bool standard_error) {
  auto logger = standard_error ? spdlog::stderr_color_mt("pilotfish") : spdlog::stdout_color_mt("pilotfish");
  logger->set_pattern("%H:%M:%S.%e %^%l%$ %v");
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(logger);
}

int fail(int code, const std::string& message) {
  std::cerr << "pilotfish-coordinator: " << message << "\n";
  return code;
}

/// Everything that a coordinator may be told between frames.
void listen(const config::CoordinatorFile& file, bus::Bus& bus, Coordinator& coordinator, Refused& refused,
            SetpointGate& gate) {
  bus.on_setpoint(file.name, [&](const bus::SetpointReport& asked) {
    const SetpointDecision decision = gate.decide(asked.session, asked.counter, asked.setpoint, coordinator.setpoint());
    if (decision.verdict != SetpointVerdict::accepted && decision.verdict != SetpointVerdict::stopped) {
      ++refused.setpoints[std::string(to_string(decision.verdict))];
      return;
    }
    const Setpoint& setpoint = decision.setpoint;
    coordinator.set_setpoint(setpoint);
    spdlog::info("setpoint: {:.2f} m at {:.1f} deg, {}", setpoint.distance_m, degrees(setpoint.bearing_rad),
                 setpoint.run ? "run" : "stop");
  });
  if (file.odometry == config::Odometry::pose)
    bus.on_pose(file.name, [&](const bus::MotionReport& own) {
      if (!coordinator.set_own_motion(own.utime, own.twist)) ++refused.own_motion;
    });
  if (!file.announcements_from.empty())
    bus.on_motion(file.announcements_from, [&](const bus::MotionReport& leader) {
      if (!coordinator.set_announced_motion(leader.utime, leader.twist)) ++refused.announcement;
    });
}

int run(const Options& options) {
  const config::CoordinatorFile file = load(options);
  std::optional<bus::Key> key;
  if (!file.key_file.empty()) key = bus::load_key(file.key_file);
  Coordinator coordinator(file.coordinator);
  Refused refused;
  try {
    bus::Bus bus(options.lcm_url);
    if (key) bus.set_key(*key);
    SetpointGate gate(bus::new_session_id(), kStopDistance_m);
    OpenedFeed source = open_feed(file, bus);
    listen(file, bus, coordinator, refused, gate);
    announce(file, bus);
    spdlog::info("ready: {}", source.description);
    const LoopConfig loop{file.name,          file.frame_rate_hz, file.coordinator.safety.max_age_s,
                          source.every_frame, options.json,       file.coordinator.control.drive.latency_s};
    control_loop(loop, *source.feed, coordinator, bus, refused, gate);
  } catch (const bus::BusError& error) {
    return fail(kUnavailable, error.what());
  } catch (const capture::CaptureError& error) {
    return fail(kUnavailable, error.what());
  }
  spdlog::info("ended; zero commands sent");
  return kOk;
}

}  // namespace
}  // namespace pilotfish::apps

int main(int argc, char** argv) {
  using namespace pilotfish;
  using namespace pilotfish::apps;
  const ParsedOptions parsed = parse_options(argc, argv);
  if (parsed.exit_code) return *parsed.exit_code;
  if (parsed.options.describe_config) {
    std::cout << config::describe_config();
    return kOk;
  }
  catch_stop_signals();
  log_to(parsed.options.json);
  try {
    return run(parsed.options);
  } catch (const ConfigError& error) {
    return fail(kConfig, std::string("bad configuration: ") + error.what());
  } catch (const std::exception& error) {
    return fail(kSoftware, error.what());
  }
}
