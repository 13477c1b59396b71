#include "crowd.hpp"

#include <algorithm>
#include <memory>
#include <numeric>

#include "loop.hpp"
#include "on_threads.hpp"

namespace pilotfish::bench {
namespace {

struct Robot {
  std::string name;
  Setpoint setpoint;
  std::unique_ptr<Coordinator> coordinator;
  Twist command;
  bool answered = false, seen = false;
  std::uint64_t picture = 0;  ///< hash of its present one
  std::int64_t capture_ns = 0, step_ns = 0, pictures_seen = 0;
  double squares_m2 = 0.0;
};

/// FNV-1a over 8 bytes at a time.
std::uint64_t hash_of(const ImageView& image) {
  std::uint64_t hash = 0xCBF29CE484222325ULL;
  for (std::size_t i = 0; i + 8 <= image.size_bytes; i += 8) {
    std::uint64_t word = 0;
    std::copy_n(image.data + i, 8, reinterpret_cast<std::uint8_t*>(&word));
    hash = (hash ^ word) * 0x100000001B3ULL;
  }
  return hash;
}

std::vector<Robot> robots_of(const sim::Scenario& scenario) {
  std::vector<Robot> robots;
  for (const sim::RobotSpec& spec : scenario.robots) {
    if (spec.follows.empty()) continue;
    CoordinatorConfig config = config::load_coordinator(spec.coordinator_file).coordinator;
    if (spec.setpoint) config.setpoint = *spec.setpoint;
    Robot robot;
    robot.name = spec.name;
    robot.setpoint = config.setpoint;
    robot.coordinator = std::make_unique<Coordinator>(config);
    robots.push_back(std::move(robot));
  }
  return robots;
}

/// A picture, and what its coordinator makes of it. Reads the world and changes this robot alone.
void look(const sim::World& world, Robot& robot) {
  const std::int64_t begin = thread_ns();
  const std::optional<Frame> picture = world.capture(robot.name);
  const std::int64_t captured = thread_ns();
  robot.capture_ns += captured - begin;
  robot.answered = picture.has_value();
  if (!picture) return;
  const StepResult result = robot.coordinator->step(*picture, {picture->utime});
  robot.step_ns += thread_ns() - captured;
  robot.command = result.command;
  robot.pictures_seen += result.observation ? 1 : 0;
  robot.picture = hash_of(picture->image);
}

}  // namespace

nlohmann::json play_crowd(const sim::Scenario& scenario, int frames, int threads) {
  const Clock::time_point begin = Clock::now();
  sim::World world(scenario);
  std::vector<Robot> robots = robots_of(world.scenario());
  const Clock::time_point made = Clock::now();
  std::vector<std::int64_t> frame_ns;
  std::int64_t move_ns = 0;
  std::uint64_t pictures = 0;
  for (int frame = 0; frame < frames; ++frame) {
    const Clock::time_point frame_begin = Clock::now();
    const std::int64_t before_move = thread_ns();
    world.advance_to(frame / scenario.frame_rate_hz);
    move_ns += thread_ns() - before_move;
    apps::on_threads(static_cast<std::size_t>(threads), robots.size(), [&](std::size_t i) { look(world, robots[i]); });
    for (Robot& robot : robots)
      if (robot.answered) world.command(robot.name, robot.command, world.time_s() + world.latency_s(robot.name));
    frame_ns.push_back(elapsed_ns(frame_begin, Clock::now()));
    for (Robot& robot : robots) {
      pictures = (pictures ^ robot.picture) * 0x100000001B3ULL;
      const double error_m = world.true_relative_pose(robot.name).distance_m - robot.setpoint.distance_m;
      if (frame >= 3 * frames / 4) robot.squares_m2 += error_m * error_m;
    }
  }
  std::int64_t capture_ns = 0, step_ns = 0, seen = 0;
  double worst_m2 = 0.0;
  for (const Robot& robot : robots) {
    capture_ns += robot.capture_ns;
    step_ns += robot.step_ns;
    seen += robot.pictures_seen;
    worst_m2 = std::max(worst_m2, robot.squares_m2 / std::max(1, frames - 3 * frames / 4));
  }
  const auto total_ns = std::accumulate(frame_ns.begin(), frame_ns.end(), std::int64_t{0});
  return {{"robots", robots.size()},
          {"frames", frames},
          {"threads", threads},
          {"made_s", 1e-9 * static_cast<double>(elapsed_ns(begin, made))},
          {"elapsed_s", 1e-9 * static_cast<double>(total_ns)},
          {"simulated_s", frames / scenario.frame_rate_hz},
          {"frame_ns", frame_ns},
          {"capture_ns", capture_ns},
          {"step_ns", step_ns},
          {"move_ns", move_ns},
          {"pictures", std::to_string(pictures)},
          {"seen", static_cast<double>(seen) / (static_cast<double>(robots.size()) * frames)},
          {"worst_rms_distance_error_m", std::sqrt(worst_m2)}};
}

}  // namespace pilotfish::bench
