#include "reporter.hpp"

#include <spdlog/spdlog.h>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::apps {
namespace {

std::string listed(const std::vector<int>& ids) {
  std::string text;
  for (const int id : ids) text += (text.empty() ? "" : ", ") + std::to_string(id);
  return text;
}

std::string listed_ids(const LeaderBody& leader) {
  std::vector<int> ids;
  for (const BodyTag& tag : leader.tags) ids.push_back(tag.id);
  return listed(ids);
}

}  // namespace

bus::StatusReport Reporter::status(const StepResult& result, const StepTiming& timing) const {
  Counters counters = parts_.refused();
  counters.insert(refused.begin(), refused.end());
  if (const std::int64_t overtaken = parts_.inbox.overtaken()) counters["frames_overtaken"] = overtaken;
  if (const std::int64_t forgotten = parts_.inbox.forgotten()) counters["messages_forgotten"] = forgotten;
  if (const std::int64_t lost = parts_.log.lost()) counters["log_lines_lost"] = lost;
  if (parts_.black_box != nullptr) {
    const blackbox::Counters box = parts_.black_box->counters();
    if (box.dropped > 0) counters["black_box_dropped"] = box.dropped;
    if (box.lost > 0) counters["black_box_lost"] = box.lost;
  }
  const SenderCounts sender = parts_.sender.counts();
  if (sender.rivals_heard > 0) counters["rival_commands"] = sender.rivals_heard;

  bus::StatusReport status = status_report(result, timing, {config_, coordinator_, sender, setpoint_counter}, counters);
  status.detail = detail(result);
  const auto stage = [&](const char* name, const StageTimes& times) {
    status.stages.push_back({name, times.counts(), times.max_ms()});
  };
  stage("waited", waited);
  stage("looked", looked);
  stage("answered", answered);
  stage("beats_late", sender.lateness);
  return status;
}

/// What the wheels will do, for when they will have done it; without a law's answer, what they are told now.
bus::MotionReport Reporter::intent(const StepResult& result) {
  const bool answered = result.control && result.control->effect_utime > 0;
  return {answered ? result.control->effect_utime : result.utime, result.command};
}

void Reporter::report(const StepResult& result, const StepTiming& timing) {
  // First of all: who follows this robot waits for it.
  if (config_.publish_intent && result.utime > 0) parts_.reports.publish(config_.robot, intent(result));
  parts_.reports.publish(config_.robot, observation_report(result, timing));
  const bus::StatusReport said = status(result, timing);
  parts_.reports.publish(config_.robot, said);
  log_change(result, said.detail);
  warn_of_losses();
  if (const auto line = summary.due(monotonic_now(), said)) spdlog::info("{}", *line);
}

void Reporter::print(const StepResult& result, const StepTiming& timing) const {
  if (config_.json) parts_.log.line(json_line(result, timing));
}

/// Once; the counters in the status go on.
void Reporter::warn_of_losses() {
  if (parts_.black_box == nullptr || warned_of_losses_ || parts_.black_box->counters().lost == 0) return;
  warned_of_losses_ = true;
  spdlog::warn("the recording loses events, the disk refuses them: {}", parts_.black_box->trouble());
}

/// What a reason's text leaves open: which ids, which sizes.
std::string Reporter::detail(const StepResult& result) const {
  const Reason reason = result.reason;
  const auto size = [](int width, int height) { return std::to_string(width) + " x " + std::to_string(height); };
  if (reason == Reason::frame_size_not_calibrated)
    return "frame " + size(picture.width, picture.height) + ", calibration " +
           size(config_.calibrated.width, config_.calibrated.height);
  if (reason == Reason::no_tag_of_the_leader)
    return "saw id " + listed(coordinator_.foreign_ids()) + ", the leader has " + listed_ids(coordinator_.leader());
  if (reason == Reason::leader_changed)
    return coordinator_.leader().name + " with tags " + listed_ids(coordinator_.leader());
  return to_text(result.refused);
}

/// One line per change of status or reason, however many frames it lasts.
void Reporter::log_change(const StepResult& result, const std::string& detail) {
  if (logged_ == std::pair(result.status, result.reason)) return;
  logged_ = {result.status, result.reason};
  const std::string reason = std::string(to_string(result.reason)) + (detail.empty() ? detail : " (" + detail + ")");
  const char* separator = reason.empty() ? "" : ": ";
  if (result.observation) {
    spdlog::info("{}{}{}  d = {:.3f} m, bearing = {:.1f} deg", to_string(result.status), separator, reason,
                 result.observation->distance_m, degrees(result.observation->bearing_rad));
  } else {
    spdlog::info("{}{}{}", to_string(result.status), separator, reason);
  }
}

}  // namespace pilotfish::apps
