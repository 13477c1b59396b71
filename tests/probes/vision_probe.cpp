// vision_probe allocations         how often observe() asks for memory while it tracks
// vision_probe corpus SEED COUNT   COUNT frames that no sender should ever send, to be run under sanitizers
//
// Prints one "key value" a line. Exits with 0 if it could do as requested and every answer was finite.
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <string>
#include <string_view>

#include "allocation_counter.hpp"
#include "hostile_frames.hpp"
#include "pilotfish/sim/renderer.hpp"
#include "pilotfish/vision/leader_observer.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::probes;
using vision::LeaderObserver;

constexpr std::int64_t kPeriod_us = 33'333;

/// A leader that drives across the picture and turns, once a second there and back.
int count_allocations() {
  if (!can_count_allocations()) {
    std::puts("built with sanitizers: allocations cannot be counted");
    return 2;
  }
  CameraModel camera = plain_camera(640, 480);
  camera.fx = camera.fy = 600.0;
  sim::RobotBody robot;
  robot.leader.tags.push_back(BodyTag{});
  const std::vector<sim::Surface> surfaces = sim::surfaces_of(robot);
  const sim::Renderer renderer(camera, {}, {}, 1);
  for (const double distance_m : {0.65, 1.1, 2.44, 5.0}) {
    LeaderObserver observer(camera, {}, robot.leader, {});
    int tracked = 0;
    std::int64_t while_tracking = 0;
    for (int k = 0; k < 30; ++k) {
      const double phase = 2.0 * 3.14159265358979 * k / 30.0;
      Eigen::Isometry3d cMo = Eigen::Isometry3d::Identity();
      cMo.linear() << 0, -1, 0, 0, 0, -1, 1, 0, 0;
      cMo.linear() *= Eigen::AngleAxisd(0.5 * std::sin(phase), Eigen::Vector3d::UnitZ()).toRotationMatrix();
      cMo.translation() << 0.1 * distance_m * std::sin(phase), 0.0, distance_m;
      sim::View view;
      view.bodies.push_back({&surfaces, cMo});
      const Frame frame = Frame::from_pixels(k * kPeriod_us, camera.width, camera.height,
                                             renderer.render({view}, static_cast<std::uint64_t>(k)));
      const std::int64_t before = allocations();
      const vision::ObservationResult sight = observer.observe(frame);
      const std::int64_t asked = allocations() - before;
      if (!sight.observation || sight.observation->found_by != FoundBy::track) continue;
      ++tracked;
      while_tracking += asked;
    }
    std::printf("tracked_at_%g_m %d\nallocations_at_%g_m %lld\n", distance_m, tracked, distance_m,
                static_cast<long long>(while_tracking));
  }
  return 0;
}

bool is_finite(const Observation& o) {
  return std::isfinite(o.distance_m) && std::isfinite(o.bearing_rad) && std::isfinite(o.heading_rad) &&
         o.covariance.allFinite() && o.measured.covariance.allFinite() && o.cMo.matrix().allFinite() &&
         std::isfinite(o.heading_ambiguity) && std::isfinite(o.ambiguity_ratio) &&
         std::isfinite(o.reprojection_error_px);
}

/// Mostly the next frame's; now and then the same, earlier, much later, or at either end of time.
std::int64_t next_utime(std::int64_t utime, RandomNumbers& random) {
  if (utime < 0 || utime > (std::int64_t{1} << 62U)) return 1'000'000;  // back from the end of time
  switch (random.below(40)) {
    case 0: return utime;
    case 1: return utime - kPeriod_us;
    case 2: return utime + 30'000'000;
    case 3: return std::numeric_limits<std::int64_t>::max();
    case 4: return std::numeric_limits<std::int64_t>::min();
    default: return utime + kPeriod_us;
  }
}

int run_corpus(std::uint64_t seed, int frames) {
  RandomNumbers random(seed);
  std::map<std::string, int> counts = {{"observed", 0}, {"tracked", 0}};
  int shown = 0;
  while (shown < frames) {
    const CameraModel camera = any_camera(random);
    const LeaderBody body = any_body(random);
    camera.validate();
    body.validate();
    vision::LeaderObserverConfig config;
    config.detector.max_hamming = random.below(2);  // more needs gigabytes with the large families
    config.detector.min_decision_margin = random.between(0.0, 30.0);
    config.acquisition_range_m = random.between(0.5, 20.0);
    config.gates.max_normalised_residual = random.once_in(2) ? 1.0 : 0.12;
    LeaderObserver observer(camera, {}, body, config);
    ++counts["observers"];
    const CameraModel plain = plain_camera(camera.width, camera.height);
    const Picture leader = with_leader(body, plain, random);
    std::int64_t utime = 1'000'000;
    // Every other frame is the leader where it was, so that there is something to follow into what comes next.
    for (int k = 0; k < 20 && shown < frames; ++k, ++shown) {
      Picture picture = random.once_in(6) ? without_sense(camera.width, camera.height, random) : leader;
      if (k % 2 == 1) disturb(picture, random);
      utime = next_utime(utime, random);
      const vision::ObservationResult sight = observer.observe(claimed(std::move(picture), utime, random));
      if (!sight.observation) {
        ++counts["refused: " + std::string(to_string(sight.reason))];
        continue;
      }
      if (!is_finite(*sight.observation)) {
        std::puts("an observation is not finite");
        return 1;
      }
      ++counts["observed"];
      if (sight.observation->found_by == FoundBy::track) ++counts["tracked"];
    }
  }
  std::printf("frames %d\n", shown);
  for (const auto& [what, count] : counts) std::printf("%s %d\n", what.c_str(), count);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view mode = argc > 1 ? argv[1] : "";
  if (mode == "allocations" && argc == 2) return count_allocations();
  if (mode == "corpus" && argc == 4) return run_corpus(std::stoull(argv[2]), std::stoi(argv[3]));
  std::puts("usage: vision_probe allocations | vision_probe corpus SEED COUNT");
  return 64;
}
