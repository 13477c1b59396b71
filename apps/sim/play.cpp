#include "play.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "on_threads.hpp"
#include "pace.hpp"
#include "pilotfish/core/angles.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "pilotfish/sim/awaited_answers.hpp"
#include "stop_signal.hpp"
#include "tell_setpoints.hpp"

namespace pilotfish::apps {
namespace {

constexpr double kAnswerWithin_s = 10.0;  // after the first answer; a coordinator takes some tens of milliseconds
constexpr double kProgressEvery_s = 2.0;
constexpr double kWheelsWatchdog_s = 0.1;

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

NoAnswer no_answer(const std::vector<std::string>& robots, double waited_s, const bus::Bus& bus) {
  std::ostringstream text;
  text << "no command from " << joined(robots) << " for " << waited_s << " s on " << bus.url()
       << "; is pilotfish-coordinator running with that --name and --lcm-url, and the source lcm?";
  return NoAnswer(text.str());
}

}  // namespace

Runner::Runner(sim::World& world, bus::Bus& bus, double wait_s, std::ostream* csv, const RunnerConfig& config)
    : world_(world),
      bus_(bus),
      wait_s_(wait_s),
      csv_(csv),
      driven_by_base_(config.driven_by_base),
      threads_(config.threads) {
  for (const sim::RobotSpec& robot : world_.scenario().robots)
    if (!robot.follows.empty()) followers_.push_back(robot.name);
  for (const std::string& robot : followers_) {
    answers_[robot] = {};
    const sim::RobotSpec& spec = *world_.scenario().find(robot);
    const auto [leader, is_new] = with_intent_.emplace(spec.follows, spec.camera->latency_s);
    if (!is_new) leader->second = std::min(leader->second, spec.camera->latency_s);
  }
  if (!config.publish_intent) with_intent_.clear();
  if (csv_ != nullptr) sim::write_recording_header(*csv_);
  last_progress_s_ = monotonic_s();
}

void Runner::publish_poses() {
  for (const sim::RobotSpec& robot : world_.scenario().robots) {
    const sim::UnicycleState state = world_.state(robot.name);
    bus_.publish(robot.name,
                 bus::PoseReport{world_.utime(), state.pose.x_m, state.pose.y_m, state.pose.heading_rad, state.twist});
  }
}

void Runner::publish_motions(bool until_delivery) {
  for (const auto& [name, latency_s] : with_intent_) {
    const sim::RobotSpec& leader = *world_.scenario().find(name);
    if (leader.trajectory && until_delivery) {
      const double then_s = world_.time_s() + latency_s;
      const std::int64_t utime = sim::kStartUtime + std::llround(then_s * 1e6);
      bus_.publish(name, bus::MotionReport{utime, sim::state_at(*leader.trajectory, leader.start, then_s).twist});
    } else {
      bus_.publish(name, bus::MotionReport{world_.utime(), world_.state(name).twist});
    }
  }
}

void Runner::publish_ranges() {
  for (const sim::RobotSpec& robot : world_.scenario().robots) {
    if (!robot.range_sensors) continue;
    if (const std::optional<RangeScan> scan = world_.ranges(robot.name)) bus_.publish(robot.name, *scan);
  }
}

void Runner::publish_image(const std::string& robot, const Frame& frame) {
  bus_.publish_image(bus::channel(robot, "IMAGE"), frame);
}

double Runner::latency_s(const std::string& robot) const { return world_.latency_s(robot); }

std::vector<std::optional<Frame>> Runner::expose() {
  std::vector<std::optional<Frame>> pictures(followers_.size());
  on_threads(threads_, pictures.size(), [&](std::size_t i) { pictures[i] = world_.capture(followers_[i]); });
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const std::string& robot = followers_[i];
    (pictures[i] ? played_.delivered : played_.dropped) += 1;
    sim::Answer& answer = answers_[robot];
    answer.delivered = pictures[i].has_value();
    if (!pictures[i]) answer.command = world_.command_in_effect(robot, world_.time_s() + latency_s(robot));
  }
  return pictures;
}

void Runner::record() {
  if (csv_ == nullptr) return;
  for (const std::string& robot : followers_) sim::write_recording_row(*csv_, world_, robot, answers_[robot]);
}

void Runner::report_progress() {
  if (monotonic_s() - last_progress_s_ < kProgressEvery_s) return;
  last_progress_s_ = monotonic_s();
  for (const std::string& robot : followers_) {
    const RelativePose truth = world_.true_relative_pose(robot);
    spdlog::info("{:.1f} of {:.1f} s: {} is {:.3f} m from {} at {:.1f} deg, {}", world_.time_s(),
                 world_.scenario().duration_s, robot, truth.distance_m, world_.scenario().find(robot)->follows,
                 degrees(truth.bearing_rad), answers_[robot].status.empty() ? "no answer yet" : answers_[robot].status);
  }
}

void Runner::report_failures() {
  const auto& rejected = bus_.rejected();
  const auto found = rejected.find("publish_failed");
  if (found == rejected.end() || found->second == failed_) return;
  failed_ = found->second;
  if (throttle_.due("publish_failed", monotonic_now()))
    spdlog::warn("{} messages could not be sent on {}: is there a route for it, and is the network up?", failed_,
                 bus_.url());
}

RunSummary Runner::play_in_lockstep() {
  sim::AwaitedAnswers awaited(kResendAfter_s, wait_s_);
  for (const std::string& robot : followers_)
    bus_.on_command(robot, [this, &awaited, robot](const bus::CommandReport& report) {
      if (!awaited.answered(robot, report.utime)) return;  // a heartbeat, or the second answer to a picture sent twice
      world_.command(robot, report.command, world_.time_s() + latency_s(robot));
      answers_[robot] = {report.command, std::string(to_string(report.status)), true};
    });

  tell_setpoints(world_.scenario(), bus_, wait_s_);
  const int frames = world_.scenario().frame_count();
  while (played_.frames < frames && !stop_requested()) {
    world_.advance_to(exposure_s(played_.frames));
    publish_poses();
    publish_motions(true);
    publish_ranges();
    std::map<std::string, Frame> pictures;
    const std::vector<std::optional<Frame>> exposed = expose();
    for (std::size_t i = 0; i < exposed.size(); ++i) {
      if (!exposed[i]) continue;
      pictures[followers_[i]] = *exposed[i];
      publish_image(followers_[i], *exposed[i]);
      awaited.sent(followers_[i], exposed[i]->utime, monotonic_s());
    }
    while (!awaited.complete() && !stop_requested()) {
      bus_.handle(5);
      for (const std::string& robot : awaited.to_resend(monotonic_s())) {
        publish_image(robot, pictures.at(robot));
        ++played_.sent_again;
      }
      report_failures();
      if (const auto silent = awaited.overdue(monotonic_s()); !silent.empty())
        throw no_answer(silent, played_.frames == 0 ? wait_s_ : kAnswerWithin_s, bus_);
    }
    if (!awaited.complete()) break;
    record();
    report_progress();
    report_failures();
    if (++played_.frames == 1) awaited = sim::AwaitedAnswers(kResendAfter_s, kAnswerWithin_s);
  }
  played_.stopped = stop_requested();
  return played_;
}

/// Coordinators send zeros while they have no picture, so that each is received before the world begins to move.
void Runner::wait_until_all_are_heard() {
  const double asked_s = monotonic_s();
  while (!stop_requested()) {
    std::vector<std::string> silent;
    for (const auto& [robot, answer] : answers_)
      if (answer.status.empty()) silent.push_back(robot);
    if (silent.empty()) return;
    if (monotonic_s() - asked_s > wait_s_) throw no_answer(silent, wait_s_, bus_);
    bus_.handle(10);
  }
}

void Runner::expose_all() {
  publish_poses();
  publish_motions(false);
  publish_ranges();
  const std::vector<std::optional<Frame>> exposed = expose();
  for (std::size_t i = 0; i < exposed.size(); ++i)
    if (exposed[i]) under_way_.push_back({world_.time_s() + latency_s(followers_[i]), followers_[i], *exposed[i]});
  record();
  report_progress();
  report_failures();
  ++played_.frames;
}

void Runner::deliver(double now_s) {
  const auto due = [now_s](const UnderWay& picture) { return picture.due_s <= now_s; };
  for (const UnderWay& picture : under_way_)
    if (due(picture)) publish_image(picture.robot, picture.frame);
  under_way_.erase(std::remove_if(under_way_.begin(), under_way_.end(), due), under_way_.end());
}

/// When the message at hand came, on the world's time: it may have waited while pictures were rendered.
double Runner::arrived_after(double start_s) const {
  return std::max(static_cast<double>(bus_.arrival().us) * 1e-6 - start_s, world_.time_s());
}

void Runner::obey_bases(const double& start_s) {
  for (const sim::RobotSpec& robot : world_.scenario().robots) {
    if (robot.trajectory) continue;
    bus_.on_base(robot.name, [this, &start_s, name = robot.name](const bus::BaseReport& report) {
      if (start_s <= 0.0) return;
      const double arrived_s = arrived_after(start_s);
      world_.command(name, report.command, arrived_s);
      commanded_s_[name] = arrived_s;
    });
  }
}

void Runner::stop_unattended_wheels(double now_s) {
  for (auto entry = commanded_s_.begin(); entry != commanded_s_.end();) {
    if (now_s - entry->second > kWheelsWatchdog_s) {
      world_.command(entry->first, {}, now_s);
      entry = commanded_s_.erase(entry);
    } else {
      ++entry;
    }
  }
}

RunSummary Runner::play_in_real_time() {
  double start_s = 0.0;  // of the world, on the monotonic clock; 0: not yet
  for (const sim::RobotSpec& robot : world_.scenario().robots) {
    if (robot.trajectory) continue;
    bus_.on_command(robot.name, [this, &start_s, name = robot.name](const bus::CommandReport& report) {
      if (start_s > 0.0 && !driven_by_base_) world_.command(name, report.command, arrived_after(start_s));
      const auto found = answers_.find(name);
      if (found == answers_.end()) return;
      found->second.command = report.command;
      found->second.status = std::string(to_string(report.status));
    });
  }
  if (driven_by_base_) obey_bases(start_s);
  wait_until_all_are_heard();
  tell_setpoints(world_.scenario(), bus_, wait_s_);

  start_s = monotonic_s();
  const int frames = world_.scenario().frame_count();
  int next = 0;
  while ((next < frames || !under_way_.empty()) && !stop_requested()) {
    double now_s = monotonic_s() - start_s;
    deliver(now_s);  // before the next exposure: its rendering is not a part of this picture's latency
    if (next < frames && now_s >= exposure_s(next)) {
      // If time was too short, go on with the exposure that is due now.
      const int due = static_cast<int>(now_s * world_.scenario().frame_rate_hz);
      const int current = std::clamp(due, next, frames - 1);
      played_.skipped += current - next;
      world_.advance_to(exposure_s(current));
      expose_all();
      next = current + 1;
      now_s = monotonic_s() - start_s;
    }
    deliver(now_s);
    stop_unattended_wheels(now_s);
    double wake_s = next < frames ? exposure_s(next) : now_s;
    for (const UnderWay& picture : under_way_)
      wake_s = next < frames ? std::min(wake_s, picture.due_s) : std::max(wake_s, picture.due_s);
    bus_.handle(std::clamp(static_cast<int>((wake_s - now_s) * 1e3), 0, commanded_s_.empty() ? 100 : 20));
  }
  played_.stopped = stop_requested();
  return played_;
}

}  // namespace pilotfish::apps
