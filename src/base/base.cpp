#include "pilotfish/base/base.hpp"

#include <algorithm>

#include "pilotfish/core/sections.hpp"

namespace pilotfish::base {
namespace {

/// The limits' time step. A longer one, after a pause, is no reason to jump.
constexpr double kLongestStep_s = 0.1;

}  // namespace

std::string_view to_string(BaseState state) noexcept {
  switch (state) {
    case BaseState::waiting: return "waiting";
    case BaseState::driving: return "driving";
    case BaseState::stopped: return "stopped";
    case BaseState::fault: return "fault";
  }
  return "unknown";
}

void Base::check(const BaseConfig& config) {
  check_tree(config, "");
  if (std::find(std::begin(kBauds), std::end(kBauds), config.serial.baud) != std::end(kBauds)) return;
  std::string known;
  for (const int baud : kBauds) known += " " + std::to_string(baud);
  throw ConfigError("serial.baud", std::to_string(config.serial.baud) + " is not a line's speed; there are" + known);
}

Base::Base(const BaseConfig& config, std::int64_t own_session, bool simulated_allowed)
    : config_(config),
      own_session_(own_session),
      guard_(config.commands, own_session, simulated_allowed),
      latch_(config.start_stopped) {
  check(config);
}

CommandVerdict Base::receive(const ReceivedCommand& command, MonotonicTime arrived, MonotonicTime now) noexcept {
  const CommandVerdict verdict = guard_.receive(command, arrived, now);
  ++refused_commands_[static_cast<std::size_t>(verdict)];
  return verdict;
}

LatchVerdict Base::receive(const ReceivedSetpoint& setpoint, MonotonicTime now) noexcept {
  const LatchVerdict verdict = latch_.receive(setpoint, guard_.accepted_session(now));
  if (verdict == LatchVerdict::other_session) ++refused_other_session_;
  if (verdict == LatchVerdict::replayed) ++refused_replayed_;
  return verdict;
}

BaseOutput Base::step(MonotonicTime now) noexcept {
  const std::optional<Twist> command = guard_.command_at(now);
  BaseOutput output;
  output.accepted_session = guard_.accepted_session(now);
  if (!driver_works_) {
    output.state = BaseState::fault;
  } else if (latch_.stopped()) {
    output.state = BaseState::stopped;
  } else if (command) {
    const double passed_s = last_command_at_ ? static_cast<double>(now.us - last_command_at_->us) * 1e-6 : 0.0;
    output.state = BaseState::driving;
    output.command =
        limit(config_.limits, config_.wheels, *command, last_command_, std::clamp(passed_s, 0.0, kLongestStep_s));
  }
  last_command_ = output.command;
  last_command_at_ = now;
  return output;
}

std::map<std::string, std::int64_t> Base::rejected() const {
  std::map<std::string, std::int64_t> counters;
  for (int i = 0; i < kCommandVerdicts; ++i) {
    const auto verdict = static_cast<CommandVerdict>(i);
    const std::int64_t count = refused_commands_[static_cast<std::size_t>(i)];
    if (verdict != CommandVerdict::accepted && count > 0) counters.emplace(to_string(verdict), count);
  }
  if (refused_other_session_ > 0) counters.emplace(to_string(LatchVerdict::other_session), refused_other_session_);
  if (refused_replayed_ > 0) counters.emplace(to_string(LatchVerdict::replayed), refused_replayed_);
  return counters;
}

}  // namespace pilotfish::base
