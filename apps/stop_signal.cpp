#include "stop_signal.hpp"

#include <atomic>
#include <csignal>
#include <ctime>

#include "fault_signals.hpp"
#include "pilotfish/bus/final_message.hpp"

namespace pilotfish::apps {
namespace {

// A signal handler can reach nothing but globals; these are the only ones. It may run on any thread, also on one that a
// library began, and another one reads what it sets: so that is atomic, not merely volatile.
std::atomic<bool> stop_flag{false};
static_assert(std::atomic<bool>::is_always_lock_free);
std::atomic<const bus::FinalMessage*> final_message{nullptr};

// All that end a process by default and are not faults. Suspending from a terminal (Ctrl-Z) would stop the commands
// of a moving robot: those are ignored.
constexpr int kStopSignals[] = {SIGINT,  SIGTERM,   SIGHUP,  SIGQUIT, SIGUSR1,   SIGUSR2,
                                SIGALRM, SIGVTALRM, SIGPROF, SIGPOLL, SIGSTKFLT, SIGPWR};
constexpr int kSuspensions[] = {SIGTSTP, SIGTTIN, SIGTTOU};

sigset_t stop_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (int signal : kStopSignals) sigaddset(&set, signal);
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) sigaddset(&set, signal);
  return set;
}

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_flag = true; };
  for (int signal : kStopSignals) sigaction(signal, &action, nullptr);
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal) sigaction(signal, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

bool stop_requested() { return stop_flag; }

void block_stop_signals() {
  const sigset_t set = stop_signals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  for (int signal : kSuspensions) std::signal(signal, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

bool wait_for_stop_signal(int timeout_ms) {
  const sigset_t set = stop_signals();
  const timespec timeout{timeout_ms / 1000, (timeout_ms % 1000) * 1'000'000L};
  return sigtimedwait(&set, nullptr, &timeout) > 0;
}

void set_final_message(const bus::FinalMessage* message) {
  final_message = message;
  on_fault([] {
    if (const bus::FinalMessage* last = final_message.exchange(nullptr)) last->send();
  });
}

}  // namespace pilotfish::apps
