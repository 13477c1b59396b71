// What the black box costs the thread that records, per frame: black_box_benchmark CONFIG DIRECTORY [frames]

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "pilotfish/blackbox/black_box.hpp"

using namespace pilotfish;

namespace {

using Clock = std::chrono::steady_clock;

class Stopwatch {
 public:
  template <class Work>
  void measure(const Work& work) {
    const Clock::time_point before = Clock::now();
    work();
    microseconds_.push_back(std::chrono::duration<double, std::micro>(Clock::now() - before).count());
  }
  void print(const char* what) {
    std::sort(microseconds_.begin(), microseconds_.end());
    const auto at = [this](double share) {
      return microseconds_[static_cast<std::size_t>(share * static_cast<double>(microseconds_.size() - 1))];
    };
    std::printf("%-34s p50 %7.1f us   p99 %7.1f us   max %7.1f us\n", what, at(0.5), at(0.99), at(1.0));
  }

 private:
  std::vector<double> microseconds_;
};

Observation seen_at(std::int64_t utime, double distance_m) {
  Observation observation;
  observation.utime = utime;
  observation.distance_m = distance_m;
  observation.covariance = Eigen::Vector3d(4e-6, 1e-6, 4e-4).asDiagonal();
  observation.measured = {{distance_m, 0.0, 0.0}, observation.covariance};
  observation.other_cMo = Eigen::Isometry3d::Identity();
  for (int id = 0; id < 3; ++id) {
    TagDetection tag;
    tag.id = id;
    tag.corners_px.fill(Eigen::Vector2d::Zero());
    observation.tags.push_back(tag);
  }
  return observation;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 64;
  const int frames = argc > 3 ? std::atoi(argv[3]) : 900;
  const config::ConfigBundle bundle = config::bundle_config(argv[1], {});
  Coordinator core(config::load_bundle(bundle).coordinator);
  config::BlackBoxConfig settings;
  settings.directory = argv[2];
  settings.picture_rate_hz = 1000.0;
  blackbox::BlackBox box(settings, {"robot1", 1, "benchmark", bundle}, core);

  const std::vector<std::uint8_t> jpeg(90'000, 7);
  const Frame picture = Frame::from_pixels(0, 640, 480, std::vector<std::uint8_t>(640 * 480, 100));
  Stopwatch frame, sent, message, copy;
  for (int k = 0; k < frames; ++k) {
    const MonotonicTime now = monotonic_now();
    const std::int64_t utime = 1'000'000 + now.us;
    const StepResult result =
        core.step_observation(utime, {seen_at(utime, 2.0 - 0.001 * (k % 100)), Reason::none, {}}, now);
    Frame asked;
    asked.utime = utime;
    frame.measure([&] { box.frame(asked, now, result, core); });
    const HeldAnswer answer = core.held().at(now, Reason::none);
    sent.measure([&] { box.sent(core.held(), now, Reason::none, answer, 1, k); });
    message.measure([&] { box.message("ROBOT1_IMAGE", jpeg.data(), jpeg.size()); });
    copy.measure([&] { box.picture(picture); });
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  frame.print("frame(): a call with its answer");
  sent.print("sent(): a command");
  message.print("message(): a JPEG of 90 kB");
  copy.print("picture(): 640x480 raw, for a copy");
  const blackbox::Counters counters = box.counters();
  std::printf("%lld events written, %lld dropped, %lld lost\n", static_cast<long long>(counters.written),
              static_cast<long long>(counters.dropped), static_cast<long long>(counters.lost));
  return 0;
}
