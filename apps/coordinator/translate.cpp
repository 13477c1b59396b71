#include "translate.hpp"

#include <nlohmann/json.hpp>

namespace pilotfish::apps {

bus::ObservationReport observation_report(const StepResult& result, const StepTiming& timing) {
  return {result.utime, result.observation, result.reason, timing.latency_s};
}

bus::StatusReport status_report(const StepResult& result, const Coordinator& coordinator, const StepTiming& timing,
                                const std::map<std::string, std::int64_t>& rejected_by_bus) {
  static_assert(bus::kStatusRules == fuzzy::kPaperRules);
  bus::StatusReport report;
  report.utime = result.utime;
  report.status = result.status;
  report.reason = result.reason;
  if (result.control) {
    const control::VelocityCommand& velocity = result.control->velocity;
    report.error_m = velocity.error_m;
    report.error_change_m = velocity.error_change_m;
    report.output = velocity.inference.output;
    report.strengths = velocity.inference.strengths;
    report.feed_forward_weight = result.control->feed_forward_weight;
    report.ego_motion = static_cast<std::int8_t>(result.control->ego_motion);
    report.leader_intent = static_cast<std::int8_t>(result.control->leader_intent);
    if (const auto& leader = result.control->leader) {
      report.leader_radial_mps = leader->radial_mps;
      report.leader_tangential_mps = leader->tangential_mps;
      report.leader_turn_rate_radps = leader->turn_rate_radps;
    }
  }
  report.setpoint = coordinator.setpoint();
  report.frame_rate_hz = timing.frame_rate_hz;
  report.processing_ms = timing.processing_s * 1e3;
  report.latency_s = timing.median_latency_s;
  report.latency_from_exposure = timing.from_exposure;
  report.rejected = rejected_by_bus;
  const vision::RejectionCounters& rejected = coordinator.rejected();
  for (const vision::RejectionCounters::Named& each : vision::RejectionCounters::all())
    if (rejected.*each.count > 0) report.rejected[each.name] = rejected.*each.count;  // there is room for 16 names
  return report;
}

std::string json_line(const StepResult& result, const StepTiming& timing) {
  nlohmann::ordered_json json;
  json["utime"] = result.utime;
  json["status"] = std::string(to_string(result.status));
  json["reason"] = std::string(to_string(result.reason));
  const bool detected = result.observation.has_value();
  json["detected"] = detected;
  const auto measured = [&](const char* key, auto value_of) {
    json[key] = detected ? nlohmann::ordered_json(value_of(*result.observation)) : nlohmann::ordered_json(nullptr);
  };
  measured("distance_m", [](const Observation& o) { return o.distance_m; });
  measured("bearing_rad", [](const Observation& o) { return o.bearing_rad; });
  measured("heading_rad", [](const Observation& o) { return o.heading_rad; });
  measured("reprojection_error_px", [](const Observation& o) { return o.reprojection_error_px; });
  measured("ambiguity_ratio", [](const Observation& o) { return o.ambiguity_ratio; });
  measured("heading_ambiguity", [](const Observation& o) { return o.heading_ambiguity; });
  measured("found_by", [](const Observation& o) { return std::string(to_string(o.found_by)); });
  json["tag_ids"] = nlohmann::ordered_json::array();
  json["decision_margins"] = nlohmann::ordered_json::array();
  json["corners_px"] = nlohmann::ordered_json::array();  // per tag four times (u, v)
  for (const TagDetection& tag : detected ? result.observation->tags : decltype(Observation::tags){}) {
    nlohmann::ordered_json corners = nlohmann::ordered_json::array();
    for (const Eigen::Vector2d& corner : tag.corners_px) corners.push_back({corner.x(), corner.y()});
    json["tag_ids"].push_back(tag.id);
    json["decision_margins"].push_back(tag.decision_margin);
    json["corners_px"].push_back(corners);
  }
  json["linear_mps"] = result.command.linear_mps;
  json["angular_radps"] = result.command.angular_radps;
  const auto decided = [&](const char* key, auto value_of) {
    json[key] = result.control ? nlohmann::ordered_json(value_of(*result.control)) : nlohmann::ordered_json(nullptr);
  };
  decided("error_m", [](const control::FollowerOutput& o) { return o.velocity.error_m; });
  decided("error_change_m", [](const control::FollowerOutput& o) { return o.velocity.error_change_m; });
  decided("output", [](const control::FollowerOutput& o) { return o.velocity.inference.output; });
  decided("feed_forward_weight", [](const control::FollowerOutput& o) { return o.feed_forward_weight; });
  decided("ego_motion", [](const control::FollowerOutput& o) { return std::string(to_string(o.ego_motion)); });
  decided("leader_intent", [](const control::FollowerOutput& o) { return std::string(to_string(o.leader_intent)); });
  const bool estimated = result.control && result.control->leader;
  const auto leader = [&](const char* key, double control::LeaderMotion::*value) {
    json[key] = estimated ? nlohmann::ordered_json((*result.control->leader).*value) : nlohmann::ordered_json(nullptr);
  };
  leader("leader_radial_mps", &control::LeaderMotion::radial_mps);
  leader("leader_tangential_mps", &control::LeaderMotion::tangential_mps);
  leader("leader_turn_rate_radps", &control::LeaderMotion::turn_rate_radps);
  json["latency_s"] = timing.median_latency_s;
  json["latency_from_exposure"] = timing.from_exposure;
  return json.dump();
}

}  // namespace pilotfish::apps
