// A whole coordinator in your own process: follow_without_lcm CONFIG FOLDER. Pictures in, speeds out; no bus.

#include <cstdio>
#include <exception>
#include <pilotfish/capture/frame_source.hpp>
#include <pilotfish/config/files.hpp>
#include <pilotfish/coordinator/coordinator.hpp>

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "follow_without_lcm CONFIG FOLDER, e.g. data/config/line.yaml pictures\n");
    return 64;
  }
  const pilotfish::config::CoordinatorFile file = pilotfish::config::load_coordinator(argv[1]);
  pilotfish::Coordinator coordinator(file.coordinator);
  const auto source = pilotfish::capture::open_images(argv[2], file.frame_rate_hz);

  while (const auto frame = source->next()) {
    // On a robot this is monotonic_now(), read when the picture arrives. Here time passes as the pictures' stamps say.
    const pilotfish::MonotonicTime now{frame->utime};
    const pilotfish::StepResult result = coordinator.step(*frame, now);
    std::printf("%.3f s: %-9s v = %+.3f m/s, w = %+.3f rad/s", static_cast<double>(frame->utime) * 1e-6,
                std::string(to_string(result.status)).c_str(), result.command.linear_mps, result.command.angular_radps);
    if (result.observation) std::printf(", d = %.3f m", result.observation->distance_m);
    std::printf("\n");
  }
  // No picture for longer than a measurement is valid: a wheel driver calls this in every period and gets a stop.
  const pilotfish::MonotonicTime later{coordinator.held().until.us + 1};
  const pilotfish::StepResult end = coordinator.command_at(later);
  std::printf("later:   %-9s v = %+.3f m/s\n", std::string(to_string(end.status)).c_str(), end.command.linear_mps);
} catch (const std::exception& error) {
  std::fprintf(stderr, "follow_without_lcm: %s\n", error.what());
  return 1;
}
