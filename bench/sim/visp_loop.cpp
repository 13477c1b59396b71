#include "visp_loop.hpp"

namespace pilotfish::bench {
namespace {

const sim::RobotSpec& spec_of(const sim::Scenario& scenario, const std::string& robot) { return *scenario.find(robot); }

const sim::CameraSpec& camera_of(const sim::Scenario& scenario, const Follower& follower) {
  return *spec_of(scenario, follower.name).camera;
}

const sim::RobotBody& leader_of(const sim::Scenario& scenario, const Follower& follower) {
  return *spec_of(scenario, spec_of(scenario, follower.name).follows).body;
}

/// What the camera sees without a robot, as it is before the noise and the sensor's response.
std::vector<std::uint8_t> background_of(const sim::CameraSpec& camera, std::uint64_t seed) {
  sim::Imperfections clean = camera.imperfections;
  clean.noise_sigma = clean.shot_noise = 0.0;
  clean.gamma = 1.0;
  return sim::Renderer(sim::real_model(camera), sim::real_mounting(camera), clean, seed).render({sim::View{}}, 0);
}

/// Errors of such measurements in these very runs, as standard deviations: see measured_* in the output. The estimator
/// of profile `anticipate` weighs measurements by them.
Eigen::Matrix3d covariance_at(double distance_m) {
  const Eigen::Vector3d sigma(0.5e-3 * distance_m * distance_m, 0.1e-3, 2e-3 * distance_m);
  return sigma.cwiseAbs2().asDiagonal();
}

}  // namespace

VispLoop::VispLoop(const std::string& name, const sim::Scenario& scenario, double decimation, bool bilinear)
    : Loop(name),
      world_(scenario),
      follower_(world_.scenario()),
      coordinator_(follower_.config),
      scene_(sim::surfaces_of(leader_of(world_.scenario(), follower_)),
             sim::real_model(camera_of(world_.scenario(), follower_)),
             camera_of(world_.scenario(), follower_).imperfections,
             background_of(camera_of(world_.scenario(), follower_), static_cast<std::uint64_t>(scenario.seed)),
             bilinear),
      tags_(follower_.config.camera, follower_.config.leader, decimation) {}

FrameFigures VispLoop::play(int frame) {
  FrameFigures figures;
  const std::int64_t begin = thread_ns();
  world_.advance_to(frame / world_.scenario().frame_rate_hz);
  const std::int64_t moved = thread_ns();
  const vpImage<unsigned char>& picture =
      scene_.picture(world_.true_cMo(follower_.name), static_cast<std::uint64_t>(frame));
  const std::int64_t rendered = thread_ns();
  vision::ObservationResult seen;
  if (const std::optional<Eigen::Isometry3d> cMo = tags_.see(picture)) {
    const RelativePose pose = relative_pose(base_from_camera(follower_.config.mounting) * *cMo);
    Observation& observation = seen.observation.emplace();
    observation.utime = world_.utime();
    observation.distance_m = pose.distance_m;
    observation.bearing_rad = pose.bearing_rad;
    observation.heading_rad = pose.heading_rad;
    observation.covariance = covariance_at(pose.distance_m);
    observation.cMo = *cMo;
  } else {
    seen.reason = Reason::no_tag_found;
  }
  const StepResult result = coordinator_.step_observation(world_.utime(), seen, {world_.utime()});
  world_.command(follower_.name, result.command, world_.time_s() + world_.latency_s(follower_.name));
  const std::int64_t commanded = thread_ns();
  figures.move_ns = moved - begin;
  figures.render_ns = rendered - moved;
  figures.see_decide_ns = commanded - rendered;
  judge(world_, follower_, seen.observation, figures);
  return figures;
}

}  // namespace pilotfish::bench
