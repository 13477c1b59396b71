#include "summary.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "pilotfish/core/angles.hpp"

namespace pilotfish::apps {

void Summary::frame(const StepResult& result, double answer_s) {
  if (!wanted_) return;
  ++frames_;
  longest_answer_s_ = std::max(longest_answer_s_, answer_s);
  command_ = result.command;
  if (!result.observation) return;
  ++measured_;
  last_ = result.observation;
}

std::optional<std::string> Summary::due(MonotonicTime now, const bus::StatusReport& status) {
  if (!wanted_) return std::nullopt;
  if (!since_) since_ = now;
  const std::int64_t passed_us = now.us - since_->us;
  if (passed_us < kEvery_us) return std::nullopt;
  std::string text = line(status, static_cast<double>(passed_us) * 1e-6);
  since_ = now;
  frames_ = measured_ = 0;
  longest_answer_s_ = 0.0;
  last_.reset();
  command_ = {};
  refused_ = status.rejected;
  return text;
}

std::string Summary::line(const bus::StatusReport& status, double seconds) const {
  std::string text = std::string(to_string(status.status));
  const std::string detail = status.detail.empty() ? "" : "; " + status.detail;
  if (status.reason != Reason::none) text += fmt::format(" ({}{})", to_string(status.reason), detail);
  if (frames_ == 0)
    return text + fmt::format(": no frame in {:.1f} s, command 0", seconds) + refused_since(status.rejected);
  text += fmt::format(": leader measured in {} of {} frames, {:.1f} Hz", measured_, frames_, frames_ / seconds);
  if (last_) {
    text += fmt::format("; d {:.3f} m ({:+.0f} mm), bearing {:.1f} deg ({:+.1f})", last_->distance_m,
                        (last_->distance_m - status.setpoint.distance_m) * 1e3, degrees(last_->bearing_rad),
                        degrees(last_->bearing_rad - status.setpoint.bearing_rad));
  }
  text += fmt::format("; v {:.3f} m/s, w {:.3f} rad/s; answered within {:.1f} ms", command_.linear_mps,
                      command_.angular_radps, longest_answer_s_ * 1e3);
  return text + refused_since(status.rejected);
}

std::string Summary::refused_since(const bus::Counters& counters) const {
  std::string text;
  for (const auto& [name, count] : counters) {
    const auto before = refused_.find(name);
    const std::int64_t more = count - (before == refused_.end() ? 0 : before->second);
    if (more > 0) text += fmt::format("{} {} {:+}", text.empty() ? "; refused:" : ",", name, more);
  }
  return text;
}

}  // namespace pilotfish::apps
