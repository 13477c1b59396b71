#include "pilotfish/base/command_guard.hpp"

#include <algorithm>

#include "pilotfish/core/utime.hpp"

namespace pilotfish::base {
namespace {

std::int64_t microseconds(double seconds) { return static_cast<std::int64_t>(seconds * 1e6); }

}  // namespace

std::string_view to_string(CommandVerdict verdict) noexcept {
  switch (verdict) {
    case CommandVerdict::accepted: return "command_accepted";
    case CommandVerdict::malformed: return "command_malformed";
    case CommandVerdict::base_session_wrong: return "base_session_wrong";
    case CommandVerdict::simulated: return "command_simulated";
    case CommandVerdict::replayed: return "command_replayed";
    case CommandVerdict::stale: return "command_stale";
    case CommandVerdict::expired: return "command_expired";
    case CommandVerdict::after_gap: return "command_after_gap";
    case CommandVerdict::session_ended: return "command_session_ended";
    case CommandVerdict::foreign: return "command_foreign";
    case CommandVerdict::sessions_full: return "command_sessions_full";
  }
  return "command_unknown";
}

CommandGuard::CommandGuard(const CommandGuardConfig& config, std::int64_t own_session, bool simulated_allowed)
    : config_(config), own_session_(own_session), simulated_allowed_(simulated_allowed) {}

CommandGuard::Sender* CommandGuard::find(std::int64_t session) noexcept {
  auto* found = std::find_if(senders_.begin(), senders_.end(), [&](const Sender& s) { return s.session == session; });
  return found == senders_.end() ? nullptr : found;
}

/// A process that was stopped, or starved, finds a queue of commands of unknown age. A pause of
/// half a command's life counts as that: for a whole life after it nothing is accepted, and by then the queue is empty.
/// Whether the sender was silent in the meantime is unknown as well: its silence is counted from now.
void CommandGuard::advance(MonotonicTime now) noexcept {
  const std::int64_t life_us = microseconds(config_.max_command_age_s);
  if (last_now_.us != 0 && now.us - last_now_.us > life_us / 2) {
    gap_until_ = {now.us + life_us};
    last_heard_ = now;
  }
  last_now_ = std::max(last_now_, now);
  if (command_ && until_ <= now) command_.reset();
  if (accepted_session_ != 0 && now.us - last_heard_.us > microseconds(config_.takeover_s)) {
    silent_ = accepted_session_;
    accepted_session_ = 0;
  }
}

CommandVerdict CommandGuard::receive(const ReceivedCommand& command, MonotonicTime arrived,
                                     MonotonicTime now) noexcept {
  advance(now);
  if (command.session == 0 || !is_finite(command.twist)) return CommandVerdict::malformed;
  const bool moves = !(command.twist == Twist{});
  if (moves && later(now.us, kLongestValidity_us) < command.valid_until.us) return CommandVerdict::malformed;
  if (command.base_session != own_session_) return CommandVerdict::base_session_wrong;

  if (command.counter < 1) return CommandVerdict::replayed;  // they begin at 1
  Sender* sender = find(command.session);
  if (sender == nullptr) {
    if (senders_.full()) return CommandVerdict::sessions_full;
    senders_.push_back({command.session, command.counter, false});
    sender = find(command.session);
  } else if (command.counter <= sender->highest_counter) {
    return CommandVerdict::replayed;
  }
  sender->highest_counter = command.counter;

  if (command.simulated && !simulated_allowed_) return CommandVerdict::simulated;
  if (sender->ended) return CommandVerdict::session_ended;
  if (accepted_session_ != 0 && accepted_session_ != command.session) return CommandVerdict::foreign;
  if (accepted_session_ == command.session) last_heard_ = now;
  if (later(arrived.us, microseconds(config_.max_command_age_s)) <= now.us) return CommandVerdict::stale;
  // The sender checked the age, and then something held it up (a stopped process, a full queue) before this left.
  if (moves && command.valid_until <= now) return CommandVerdict::expired;
  if (now < gap_until_) return CommandVerdict::after_gap;
  // A sender that was only silent (a process that was stopped for a while) may go on, with counters that still rise.
  // Once another one is active, its session has ended for good.
  if (silent_ != 0 && silent_ != command.session) find(silent_)->ended = true;
  silent_ = 0;
  accepted_session_ = command.session;
  last_heard_ = now;
  until_ = {later(std::min(arrived, now).us, microseconds(config_.max_command_age_s))};
  if (moves) until_ = std::min(until_, command.valid_until);
  command_ = command.twist;
  return CommandVerdict::accepted;
}

std::optional<Twist> CommandGuard::command_at(MonotonicTime now) noexcept {
  advance(now);
  return command_;
}

std::optional<MonotonicTime> CommandGuard::deadline() const noexcept {
  if (!command_) return std::nullopt;
  return until_;
}

std::int64_t CommandGuard::accepted_session(MonotonicTime now) noexcept {
  advance(now);
  return accepted_session_;
}

}  // namespace pilotfish::base
