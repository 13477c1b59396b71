#include "supervisor.hpp"

#include <spdlog/spdlog.h>

#include <cstdlib>

#include "exit_codes.hpp"
#include "stop_signal.hpp"

namespace pilotfish::apps {
namespace {

constexpr int kLook_ms = 50;
constexpr std::int64_t kEndWithin_us = 3'000'000;
/// Longer than the processing of any frame takes; the wheels have zeros all that time.
constexpr std::int64_t kTurnWithin_us = 2'000'000;

}  // namespace

Supervisor::Supervisor(CommandSender& sender, Inbox& inbox)
    : sender_(sender), inbox_(inbox), service_(service_environment()), thread_([this] { run(); }) {}

Supervisor::~Supervisor() {
  over_ = true;
  thread_.join();
  if (finishing_.joinable()) finishing_.join();
}

void Supervisor::ready(const std::string& source) {
  service_.ready("looking through " + source);
  ready_ = true;
}

void Supervisor::fail(const std::string& problem) {
  failed_ = true;
  spdlog::critical("{}", problem);
  stop(Reason::internal_error);
}

void Supervisor::stop(Reason reason) {
  ending_ = true;  // first: a sender that is stuck in publishing keeps whoever finishes it
  sender_.finish(reason);
  stopping_ = true;  // then: the main thread finishes it as well, with a reason of its own, which must not be the first
  inbox_.wake();
}

void Supervisor::watch() {
  const MonotonicTime now = monotonic_now();
  const std::int64_t turns = turns_, beats = sender_.beats();
  if (turns != last_turns_) looked_at_ = now;
  if (beats != last_beats_ && now.us - looked_at_.us <= kTurnWithin_us) service_.progress(now);
  last_turns_ = turns;
  last_beats_ = beats;
}

void Supervisor::run() {
  std::optional<MonotonicTime> since;
  while (!over_) {
    if (wait_for_stop_signal(kLook_ms) && !finishing_.joinable())
      finishing_ = std::thread([this] { stop(Reason::stop_requested); });  // this thread keeps the time
    if (!ending_) {
      if (ready_) watch();
      continue;
    }
    if (!since) {
      since = monotonic_now();
      service_.stopping();
    }
    // The zeros were sent long ago. A thread is stuck.
    if (monotonic_now().us - since->us > kEndWithin_us) std::_Exit(failed_ ? kSoftware : kOk);
  }
}

}  // namespace pilotfish::apps
