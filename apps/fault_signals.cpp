#include "fault_signals.hpp"

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <exception>

namespace pilotfish::apps {
namespace {

using Say = void (*)();

// A signal handler can reach nothing but globals.
std::atomic<Say> say_before_the_end{nullptr};

constexpr int kFaults[] = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSYS, SIGTRAP, SIGXCPU, SIGXFSZ};

void say_it() {
  if (const Say say = say_before_the_end.load()) say();
}

}  // namespace

void on_fault(Say say) noexcept {
  say_before_the_end = say;
  struct sigaction action {};
  // Once, then the default, which ends the process as usual: the signal waits until the handler returns.
  action.sa_handler = [](int signal) {
    say_it();
    raise(signal);
  };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : kFaults) sigaction(signal, &action, nullptr);
  std::set_terminate([] {
    say_it();
    std::abort();
  });
}

}  // namespace pilotfish::apps
