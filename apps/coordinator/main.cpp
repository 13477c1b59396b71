// pilotfish-coordinator: the onboard program. Reads the configuration, opens the bus and the source, starts its
// threads:
//
//   BusListener   everything that comes over the bus --> Inbox
//   CameraReader  a live camera's frames             --> Inbox
//   control_loop  Inbox --> Coordinator::step --> CommandSender, observation, status      (the main thread)
//   CommandSender a command every period and at the deadline, independent of the others
//   Supervisor    signals, the service manager, and that the end comes in time
//
// Nothing is opened before the configuration is known to be good.

#include <spdlog/spdlog.h>

#include <atomic>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <thread>

#include "bus_listener.hpp"
#include "camera_reader.hpp"
#include "command_sender.hpp"
#include "control_loop.hpp"
#include "exit_codes.hpp"
#include "guarded.hpp"
#include "log.hpp"
#include "options.hpp"
#include "pilotfish/blackbox/black_box.hpp"
#include "pilotfish/bus/log_reader.hpp"
#include "pilotfish/capture/frame_source.hpp"
#include "pilotfish/config/bundle.hpp"
#include "pilotfish/config/describe.hpp"
#include "pilotfish/config/files.hpp"
#include "pilotfish/core/angles.hpp"
#include "real_time.hpp"
#include "service_notify.hpp"
#include "standard_streams.hpp"
#include "stop_signal.hpp"
#include "supervisor.hpp"

namespace pilotfish::apps {
namespace {

config::ConfigOverrides overrides(const Options& options) { return {options.law, options.profile, options.tuning}; }

config::CoordinatorFile load(const Options& options) {
  config::CoordinatorFile file = config::load_coordinator(options.config_path);
  override_name(options, file.name);
  if (options.source) file.source = *options.source;
  try {
    parse_source(file.source);
  } catch (const std::invalid_argument& error) {
    throw ConfigError("source", error.what());
  }
  config::apply(overrides(options), file);
  if (options.black_box) file.black_box.directory = *options.black_box;
  if (options.record) {
    file.black_box.directory = *options.record;
    file.black_box.picture_rate_hz = config::kEveryPicture_hz;
    file.black_box.raw_pictures = file.black_box.raw_pictures || options.record_raw;
  }
  if (options.odometry) file.odometry = config::odometry_from(*options.odometry);
  if (options.leader_intent_from) file.leader_intent_from = config::leader_intent_from(*options.leader_intent_from);
  file.publish_intent = file.publish_intent || options.publish_intent;
  return file;
}

/// Prints what will be used, so that a log shows the settings.
std::string described(const LeaderBody& leader) {
  std::string text = leader.name + ": " + leader.family + " with tags";
  for (const BodyTag& tag : leader.tags) text += " " + std::to_string(tag.id);
  return text;
}

void log_start(const config::CoordinatorFile& file, const bus::Bus& bus) {
  const CoordinatorConfig& config = file.coordinator;
  spdlog::info("robot {}: law {}, profile {}, keep {:.2f} m at {:.1f} deg{}", file.name, config.control.active_law,
               to_string(config.control.profile), config.setpoint.distance_m, degrees(config.setpoint.bearing_rad),
               config.setpoint.run ? "" : " (setpoint.run is false: it waits for `pilotfish go " + file.name + "`)");
  spdlog::info("camera {} x {} px, f = {:.1f} px{}", config.camera.width, config.camera.height, config.camera.fx,
               config.camera.lens == Lens::kannala_brandt ? ", a fisheye (Kannala-Brandt)"
               : config.camera.has_distortion()           ? ", with distortion (Brown-Conrady)"
                                                          : "");
  spdlog::info("leader {}", described(config.leader));
  for (const AlternativeLeader& other : config.other_leaders)
    spdlog::info("after {:.1f} s without it {}, at {:.2f} m and {:.1f} deg", config.alternatives.after_lost_s,
                 described(other.leader), other.distance_m, degrees(other.bearing_rad));
  spdlog::info("fuzzy law {}: {} rules; limits {:.2f} m/s, {:.2f} m/s2, {:.2f} rad/s", config.control.law.name,
               config.control.law.rules.size(), config.control.limits.max_linear_mps,
               config.control.limits.max_linear_acceleration_mps2, config.control.limits.max_angular_radps);
  if (file.coordinator.control.avoidance.enabled)
    spdlog::info("obstacles: ranges on {}, without which it does not drive", bus::channel(file.name, "RANGES"));
  if (file.odometry == config::Odometry::pose)
    spdlog::info("own motion: odometry on {}", bus::channel(file.name, "POSE"));
  if (!file.leader_intent_from.empty())
    spdlog::info("leader intent on {}", bus::channel(file.leader_intent_from, "MOTION"));
  if (file.publish_intent) spdlog::info("own intent on {}", bus::channel(file.name, "MOTION"));
  spdlog::info("bus {} (receive buffer {} bytes)", bus.url(), bus.receive_buffer_bytes());
}

struct OpenedSource {
  std::string description;
  std::function<std::optional<Frame>()> pull;  ///< files
  std::unique_ptr<CameraReader> camera;
};

OpenedSource open_source(const config::CoordinatorFile& file, const std::shared_ptr<Inbox>& inbox) {
  using Kind = SourceSpec::Kind;
  const SourceSpec spec = parse_source(file.source);
  const std::string image_channel = bus::channel(file.name, "IMAGE");
  const auto pull = [](const std::shared_ptr<capture::FrameSource>& source) {
    return OpenedSource{source->describe(), [source] { return source->next(); }, nullptr};
  };
  switch (spec.kind) {
    case Kind::camera: {
      const OpenSource open = [index = std::stoi(spec.argument), camera = file.coordinator.camera,
                               rate = file.frame_rate_hz] {
        return capture::open_camera(index, camera.width, camera.height, rate);
      };
      auto source = open();
      const std::string description = source->describe();
      return {description, nullptr, std::make_unique<CameraReader>(std::move(source), open, inbox)};
    }
    case Kind::video: return pull(capture::open_video(spec.argument));
    case Kind::images: return pull(capture::open_images(spec.argument, file.frame_rate_hz));
    case Kind::log: {
      auto reader = std::make_shared<bus::LogReader>(spec.argument, image_channel);
      return {image_channel + " in " + spec.argument, [reader] { return reader->next(); }, nullptr};
    }
    case Kind::lcm: break;
  }
  return {"LCM channel " + (spec.argument.empty() ? image_channel : spec.argument), nullptr, nullptr};
}

int fail(int code, const std::string& message) {
  std::cerr << "pilotfish-coordinator: " << message << "\n";
  return code;
}

/// A coordinator that starts checks this long for another one of its name; those send every 50 ms.
constexpr int kRivalWithin_ms = 300;

bool is_replay(const std::string& source) {
  using Kind = SourceSpec::Kind;
  const Kind kind = parse_source(source).kind;
  return kind == Kind::video || kind == Kind::images || kind == Kind::log;
}

/// A replay does not send on a live bus, unless that is requested.
std::string bus_url(const Options& options, bool replay) {
  if (!replay || options.live) return options.lcm_url;
  return options.lcm_url.empty() ? "memq://" : options.lcm_url;
}

/// A recording that is not whole must not be found out later.
void log_losses(const blackbox::BlackBox* black_box) {
  if (black_box == nullptr) return;
  const blackbox::Counters counters = black_box->counters();
  if (counters.lost + counters.dropped == 0) return;
  spdlog::warn("the recording is not whole: {} events written, {} refused by the disk, {} that came too fast for it",
               counters.written, counters.lost, counters.dropped);
}

/// Where the pictures are not on the bus already; and a replay has no one who watches, unless it is live.
std::unique_ptr<Preview> make_preview(const config::CoordinatorFile& file, SourceSpec::Kind source,
                                      const std::string& url, bool replay, bool live) {
  const bool on_the_bus = source == SourceSpec::Kind::lcm;
  if (file.preview.rate_hz <= 0.0 || on_the_bus || (replay && !live)) return nullptr;
  return std::make_unique<Preview>(file.preview, file.name, url);
}

int run(const Options& options, const config::CoordinatorFile& file, Log& log) {
  std::optional<bus::Key> key;
  if (!file.key_file.empty()) key = bus::load_key(file.key_file);
  Coordinator coordinator(file.coordinator);
  const bool replay = is_replay(file.source), simulated = replay || options.simulated_time;
  const std::int64_t session = bus::new_session_id();
  const SourceSpec spec = parse_source(file.source);
  const auto inbox = std::make_shared<Inbox>();

  ListenerConfig listening;
  listening.robot = file.name;
  listening.url = bus_url(options, replay);
  listening.key = key;
  listening.session = session;
  listening.stop_distance_m = file.coordinator.safety.stop_distance_m;
  listening.setpoint = file.coordinator.setpoint;
  if (spec.kind == SourceSpec::Kind::lcm)
    listening.image_channel = spec.argument.empty() ? bus::channel(file.name, "IMAGE") : spec.argument;
  listening.width = file.coordinator.camera.width;
  listening.height = file.coordinator.camera.height;
  listening.simulated = simulated;
  listening.odometry = file.odometry == config::Odometry::pose;
  listening.ranges = file.coordinator.control.avoidance.enabled;
  listening.leader_intent_from = file.leader_intent_from;
  BusListener listener(listening, inbox);
  if (const auto rival = listener.rival_within(listener.bus().receive_buffer_bytes() > 0 ? kRivalWithin_ms : 0))
    return fail(kUnavailable, "another coordinator (session " + std::to_string(*rival) + ") already commands " +
                                  file.name + " on " + listener.bus().url() +
                                  "; end it, or give this one another --name or --lcm-url");
  OpenedSource source = open_source(file, inbox);

  std::unique_ptr<blackbox::BlackBox> black_box;
  if (!file.black_box.directory.empty()) {
    const config::ConfigBundle bundle = config::bundle_config(options.config_path, overrides(options));
    black_box = std::make_unique<blackbox::BlackBox>(
        file.black_box, blackbox::Start{file.name, session, options.command_line, bundle}, coordinator);
  }
  bus::Bus commands(listening.url), reports(listening.url);
  if (key) {
    commands.set_key(*key);
    reports.set_key(*key);
  }
  if (black_box) {
    const auto tap = [box = black_box.get()](const std::string& channel, const std::vector<std::uint8_t>& bytes) {
      box->message(channel, bytes.data(), bytes.size());
    };
    commands.on_published(tap);
    reports.on_published(tap);
  }
  // After these no command of this session counts any more.
  bus::CommandReport final_command;
  final_command.session = session;
  final_command.counter = std::numeric_limits<std::int64_t>::max();
  final_command.status = Status::invalid_input;
  final_command.reason = Reason::internal_error;
  const std::unique_ptr<bus::FinalMessage> final_message = commands.final_message(file.name, final_command);
  set_final_message(final_message.get());

  lock_memory();
  SenderConfig sending{session, file.frame_rate_hz, file.coordinator.safety.max_age_s, simulated, nullptr};
  if (black_box)
    sending.record = [box = black_box.get(), session](const HeldCommand& held, MonotonicTime asked_at, Reason missing,
                                                      const HeldAnswer& sent, std::int64_t counter) {
      box->sent(held, asked_at, missing, sent, session, counter);
    };
  CommandSender sender(sending, [&](const bus::CommandReport& report) { commands.publish(file.name, report); });
  Supervisor supervisor(sender, *inbox);
  listener.start(sender, [&](const std::string& problem) { supervisor.fail("the bus: " + problem); });

  log_start(file, listener.bus());
  if (black_box) spdlog::info("black box: {} MB at most in {}", file.black_box.total_mb, file.black_box.directory);
  if (simulated)
    spdlog::info("time is simulated: it passes as the frames' stamps say, and real wheels ignore the commands");
  spdlog::info("ready: {}", source.description);
  const LoopConfig loop{file.name,
                        session,
                        file.frame_rate_hz,
                        simulated,
                        options.json,
                        !options.quiet && service_environment().socket.empty(),
                        file.coordinator.safety.max_age_s,
                        {file.coordinator.camera.width, file.coordinator.camera.height},
                        file.coordinator.control.drive.latency_s,
                        file.publish_intent};
  supervisor.ready(source.description);
  const std::unique_ptr<Preview> preview = make_preview(file, spec.kind, listening.url, replay, options.live);
  const LoopParts parts{*inbox,
                        source.pull,
                        sender,
                        reports,
                        log,
                        [&] { return listener.refused(); },
                        [&] { return supervisor.stop_requested(); },
                        [&] { supervisor.looked(); },
                        black_box.get(),
                        preview.get()};
  if (!simulated) become_real_time("vision", kVisionPriority);  // last: threads inherit it
  try {
    control_loop(loop, parts, coordinator);
  } catch (const std::exception& error) {
    supervisor.fail(error.what());
  }
  sender.finish(Reason::stop_requested);
  supervisor.ended();
  source.camera.reset();
  listener.stop();
  set_final_message(nullptr);
  log_losses(black_box.get());
  if (supervisor.failed()) return kSoftware;
  spdlog::info("ended; zero commands sent");
  return kOk;
}

/// The program, from its command line to its exit code.
int program(int argc, char** argv) {
  fill_missing_standard_streams();
  const ParsedOptions parsed = parse_options(argc, argv);
  if (parsed.exit_code) return *parsed.exit_code;
  const Options& options = parsed.options;
  if (describes_config(options, config::describe_config, config::describe_config_as_json_schema)) return kOk;
  int code = kSoftware;
  block_stop_signals();  // before the first thread, which inherits it
  try {
    const config::CoordinatorFile file = load(options);
    const bool replay = is_replay(file.source);
    if (replay && !options.live && options.lcm_url.rfind("memq://", 0) != 0 && !options.lcm_url.empty())
      return fail(kUsage, "--source " + file.source + " would be replayed on " + options.lcm_url +
                              ", where it could drive a robot; say --live if you mean that");
    Log log({options.json, !replay});
    if (options.quiet) spdlog::set_level(spdlog::level::warn);
    try {
      code = run(options, file, log);
    } catch (const bus::BusError& error) {
      code = fail(kUnavailable, error.what());
    } catch (const capture::CaptureError& error) {
      code = fail(kUnavailable, error.what());
    }
    if (!log.drain()) std::_Exit(code);  // a thread is stuck in write(2), and joining it would never end
  } catch (const ConfigError& error) {
    return fail(kConfig, std::string("bad configuration: ") + error.what());
  } catch (const std::exception& error) {
    return fail(kSoftware, error.what());
  }
  return code;
}

}  // namespace
}  // namespace pilotfish::apps

int main(int argc, char** argv) {
  using namespace pilotfish::apps;
  return guarded("pilotfish-coordinator", [argc, argv] { return program(argc, argv); });
}
