#include "pilotfish/sim/world.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>

#include "random.hpp"

namespace pilotfish::sim {

Eigen::Isometry3d world_from_base(const Pose2& pose) {
  Eigen::Isometry3d wMb = Eigen::Isometry3d::Identity();
  wMb.linear() = Eigen::AngleAxisd(pose.heading_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  wMb.translation() = Eigen::Vector3d(pose.x_m, pose.y_m, 0.0);
  return wMb;
}

namespace {

constexpr int kBandRows = 8;  ///< of a rolling shutter: at 1000 px/s and 30 ms in 480 rows, half a pixel between bands

template <class Config>
bool same(const Config& one, const Config& other) {
  const auto& all = Config::parameters();
  return std::all_of(all.begin(), all.end(), [&](const Parameter<Config>& parameter) {
    return std::visit([&](auto member) { return one.*member == other.*member; }, parameter.member);
  });
}

bool same_lens(const CameraModel& a, const CameraModel& b) {
  const auto fields = [](const CameraModel& m) {
    return std::make_tuple(m.width, m.height, m.fx, m.fy, m.cx, m.cy, m.k1, m.k2, m.p1, m.p2, m.k3, m.k4, m.lens);
  };
  return fields(a) == fields(b);
}

/// Whether both take the same pictures of the same view.
bool same_pictures(const CameraSpec& one, const CameraSpec& other) {
  return same_lens(real_model(one), real_model(other)) && same(real_mounting(one), real_mounting(other)) &&
         same(one.imperfections, other.imperfections);
}

}  // namespace

World::World(Scenario scenario) : scenario_(std::move(scenario)) {
  scenario_.validate();
  obstacles_ = scenario_.all_obstacles();
  for (const Obstacle& obstacle : obstacles_) obstacle_surfaces_.push_back(surfaces_of(obstacle));
  const auto seed = static_cast<std::uint64_t>(scenario_.seed);
  for (const RobotSpec& spec : scenario_.robots) {
    Robot robot;
    robot.spec = &spec;
    robot.unicycle = Unicycle(spec.drive, spec.start, seed_for(seed_for(seed, "slip"), spec.name));
    if (spec.body) robot.surfaces = surfaces_of(*spec.body);
    if (spec.camera) {
      // One room for all cameras. It takes megabytes and some tens of milliseconds: equal cameras share it.
      const auto equal = std::find_if(robots_.begin(), robots_.end(), [&](const auto& entry) {
        return entry.second.renderer && same_pictures(*entry.second.spec->camera, *spec.camera);
      });
      if (equal != robots_.end())
        robot.renderer = equal->second.renderer;
      else
        robot.renderer.emplace(real_model(*spec.camera), real_mounting(*spec.camera), spec.camera->imperfections,
                               seed_for(seed, "clutter"));
    }
    robots_.emplace(spec.name, std::move(robot));
  }
}

std::int64_t World::utime() const { return kStartUtime + std::llround(time_s_ * 1e6); }

std::int64_t World::frame_index() const { return std::llround(time_s_ * scenario_.frame_rate_hz); }

bool World::command(const std::string& name, const Twist& twist, double effective_time_s) {
  this->robot(name);  // checks the name
  Robot& robot = robots_.at(name);
  if (!is_finite(twist) || !std::isfinite(effective_time_s) || robot.spec->trajectory) return false;
  const Pending pending{std::max(effective_time_s, time_s_), twist};
  const auto later = std::upper_bound(robot.pending.begin(), robot.pending.end(), pending,
                                      [](const Pending& a, const Pending& b) { return a.time_s < b.time_s; });
  robot.pending.insert(later, pending);
  return true;
}

void World::advance_to(double time_s) {
  if (!(time_s > time_s_ && time_s <= kNever_s)) return;
  for (auto& [name, robot] : robots_)
    if (!robot.spec->trajectory) drive(robot, time_s);
  time_s_ = time_s;
}

/// From now until `until_s`, cut where another command begins to act or the acting one runs out.
void World::drive(Robot& robot, double until_s) const {
  const double timeout_s = robot.spec->drive.command_timeout_s;
  double now_s = time_s_;
  while (now_s < until_s) {
    while (!robot.pending.empty() && robot.pending.front().time_s <= now_s) {
      robot.in_effect = robot.pending.front();
      robot.pending.pop_front();
    }
    const double runs_out_s = timeout_s > 0.0 ? robot.in_effect.time_s + timeout_s : kNever_s;
    double next_s = until_s;
    if (!robot.pending.empty()) next_s = std::min(next_s, robot.pending.front().time_s);
    const bool fresh = now_s < runs_out_s;
    if (fresh) next_s = std::min(next_s, runs_out_s);
    robot.unicycle.advance(fresh ? robot.in_effect.twist : Twist{}, next_s - now_s);
    now_s = next_s;
  }
}

const World::Robot& World::robot(const std::string& name) const {
  const auto found = robots_.find(name);
  if (found != robots_.end()) return found->second;
  std::string known;
  for (const auto& entry : robots_) known += (known.empty() ? "" : ", ") + entry.first;
  throw std::out_of_range("there is no robot '" + name + "' in this world, but " + known);
}

const World::Robot& World::leader_of(const Robot& follower) const {
  if (follower.spec->follows.empty()) throw std::out_of_range("'" + follower.spec->name + "' follows no robot");
  return robot(follower.spec->follows);
}

const CameraSpec& World::camera_of(const Robot& robot) {
  if (!robot.spec->camera) throw std::out_of_range("'" + robot.spec->name + "' has no camera");
  return *robot.spec->camera;
}

std::uint64_t World::frame_seed(const Robot& robot, const char* purpose) const {
  const std::uint64_t seed = seed_for(seed_for(static_cast<std::uint64_t>(scenario_.seed), purpose), robot.spec->name);
  return seed_for(seed, static_cast<std::uint64_t>(frame_index()));
}

/// Not further away than half an exposure: a robot without a trajectory moves on with its present twist.
UnicycleState World::state_near_now(const Robot& robot, double offset_s) const {
  const RobotSpec& spec = *robot.spec;
  if (spec.trajectory) return state_at(*spec.trajectory, spec.start, time_s_ + offset_s);
  const UnicycleState& now = robot.unicycle.state();
  return {move_along_arc(now.pose, now.twist, offset_s), now.twist};
}

UnicycleState World::state(const std::string& name) const { return state_near_now(robot(name), 0.0); }

Twist World::command_in_effect(const std::string& name, double time_s) const {
  const Robot& robot = this->robot(name);
  Pending acting = robot.in_effect;
  for (const Pending& pending : robot.pending)
    if (pending.time_s <= time_s) acting = pending;
  const double timeout_s = robot.spec->drive.command_timeout_s;
  return timeout_s > 0.0 && time_s >= acting.time_s + timeout_s ? Twist{} : acting.twist;
}

Eigen::Isometry3d World::camera_in_world(const Robot& robot, double offset_s) const {
  const Eigen::Isometry3d wMb = world_from_base(state_near_now(robot, offset_s).pose);
  const CameraSpec& camera = camera_of(robot);
  Eigen::Isometry3d bMc = base_from_camera(real_mounting(camera));
  if (camera.vibration_rad > 0.0) {
    Random random(frame_seed(robot, "vibration"));
    bMc.rotate(Eigen::AngleAxisd(camera.vibration_rad * random.normal(), Eigen::Vector3d::UnitX()));
    bMc.rotate(Eigen::AngleAxisd(camera.vibration_rad * random.normal(), Eigen::Vector3d::UnitZ()));
  }
  return wMb * bMc;
}

double World::latency_s(const std::string& name) const {
  const Robot& robot = this->robot(name);
  const CameraSpec& camera = camera_of(robot);
  return camera.latency_s + camera.latency_jitter_s * (2.0 * Random(frame_seed(robot, "latency")).uniform() - 1.0);
}

Eigen::Isometry3d World::true_cMo(const std::string& name) const {
  const Robot& follower = robot(name);
  return camera_in_world(follower, 0.0).inverse() * world_from_base(state_near_now(leader_of(follower), 0.0).pose);
}

RelativePose World::true_relative_pose(const std::string& name) const {
  const Robot& follower = robot(name);
  return relative_pose(world_from_base(state_near_now(follower, 0.0).pose).inverse() *
                       world_from_base(state_near_now(leader_of(follower), 0.0).pose));
}

View World::view(const Robot& viewer, double offset_s) const {
  const Eigen::Isometry3d cMw = camera_in_world(viewer, offset_s).inverse();
  View view;
  view.camera_heading_rad = state_near_now(viewer, offset_s).pose.heading_rad;
  for (const auto& [name, robot] : robots_) {
    if (&robot == &viewer || robot.surfaces.empty() || !robot.spec->visibility.visible_at(time_s_)) continue;
    view.bodies.push_back({&robot.surfaces, cMw * world_from_base(state_near_now(robot, offset_s).pose)});
  }
  for (std::size_t i = 0; i < obstacles_.size(); ++i)
    view.bodies.push_back({&obstacle_surfaces_[i], cMw * world_from_base({obstacles_[i].x_m, obstacles_[i].y_m, 0.0})});
  return view;
}

/// Obstacles and other robots, these as cylinders of their outline and as high as their box.
std::vector<Obstacle> World::around(const Robot& own, const Robot* without) const {
  std::vector<Obstacle> all = obstacles_;
  for (const auto& [name, robot] : robots_) {
    if (&robot == &own || &robot == without) continue;
    const Pose2 pose = state_near_now(robot, 0.0).pose;
    Obstacle cylinder;
    cylinder.x_m = pose.x_m;
    cylinder.y_m = pose.y_m;
    cylinder.radius_m = robot.spec->radius_m;
    const bool box = robot.spec->body && robot.spec->body->box_size_m[2] > 0.0;
    cylinder.height_m = box ? robot.spec->body->box_position_m[2] + robot.spec->body->box_size_m[2] / 2.0 : 0.0;
    all.push_back(cylinder);
  }
  return all;
}

std::optional<RangeScan> World::ranges(const std::string& name) const {
  const Robot& robot = this->robot(name);
  if (!robot.spec->range_sensors) throw std::out_of_range("'" + name + "' has no range sensors");
  const RangeSensors& sensors = *robot.spec->range_sensors;
  // Rounds are due at j / rate, and happen with the first exposure that is not before.
  const auto rounds = [&](std::int64_t frame) {
    return std::floor(static_cast<double>(frame) * sensors.rate_hz / scenario_.frame_rate_hz + 1e-9);
  };
  if (frame_index() > 0 && rounds(frame_index()) == rounds(frame_index() - 1)) return std::nullopt;
  const Eigen::Isometry3d bMw = world_from_base(state_near_now(robot, 0.0).pose).inverse();
  std::vector<Circle2> circles;
  for (const Obstacle& each : around(robot, nullptr)) {
    const Eigen::Vector3d centre = bMw * Eigen::Vector3d(each.x_m, each.y_m, 0.0);
    circles.push_back({centre.x(), centre.y(), each.radius_m});
  }
  return scan_of(sensors, circles, utime(), frame_seed(robot, "ranges"));
}

double World::clearance_m(const std::string& name) const {
  const Robot& robot = this->robot(name);
  const Pose2 own = state_near_now(robot, 0.0).pose;
  double least_m = std::numeric_limits<double>::infinity();
  for (const Obstacle& each : around(robot, nullptr))
    least_m = std::min(least_m, std::hypot(each.x_m - own.x_m, each.y_m - own.y_m) - each.radius_m);
  return least_m - robot.spec->radius_m;
}

/// Of each tag two lines of sight count, to the middles of its left and its right edge.
bool World::leader_in_sight(const std::string& name) const {
  const Robot& follower = robot(name);
  const Robot& leader = leader_of(follower);
  if (!leader.spec->visibility.visible_at(time_s_)) return false;
  const Eigen::Vector3d eye = camera_in_world(follower, 0.0).translation();
  const Eigen::Isometry3d wMl = world_from_base(state_near_now(leader, 0.0).pose);
  const std::vector<Obstacle> between = around(follower, &leader);
  for (const BodyTag& tag : leader.spec->body->leader.tags) {
    const Eigen::Isometry3d wMt = wMl * body_from_tag(tag);
    if (wMt.linear().col(2).dot(wMt.translation() - eye) <= 0.0) continue;  // z points into the wall
    const Eigen::Vector3d half = wMt.linear().col(0) * tag.size_m / 2.0;
    const auto free = [&](const Eigen::Vector3d& edge) {
      return std::none_of(between.begin(), between.end(),
                          [&](const Obstacle& obstacle) { return hides(obstacle, eye, edge); });
    };
    if (free(wMt.translation() - half) && free(wMt.translation() + half)) return true;
  }
  return false;
}

std::optional<Frame> World::capture(const std::string& name) const {
  const Robot& viewer = robot(name);
  const CameraSpec& spec = camera_of(viewer);
  if (Random(frame_seed(viewer, "drop")).uniform() < spec.drop_probability) return std::nullopt;

  const Imperfections& imperfections = viewer.renderer->imperfections();
  const int samples = imperfections.exposure_time_s > 0.0 ? imperfections.exposure_samples : 1;
  const CameraModel& camera = viewer.renderer->camera();
  const int rows = imperfections.readout_s > 0.0 ? kBandRows : camera.height;
  std::vector<RowBand> bands;
  for (int first = 0; first < camera.height; first += rows) {
    RowBand band{std::min(first + rows, camera.height), {}};
    const double share = 0.5 * (first + band.end_row) / camera.height - 0.5;
    for (int i = 0; i < samples; ++i)
      band.instants.push_back(
          view(viewer, imperfections.readout_s * share + imperfections.exposure_time_s * ((i + 0.5) / samples - 0.5)));
    bands.push_back(std::move(band));
  }
  return Frame::from_pixels(utime(), camera.width, camera.height,
                            viewer.renderer->render_bands(bands, frame_seed(viewer, "noise")));
}

}  // namespace pilotfish::sim
