#include "stop_signal.hpp"

#include <csignal>

namespace pilotfish::apps {
namespace {

// A signal handler can reach nothing but a global; this is the only one.
volatile std::sig_atomic_t stop_flag = 0;

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = [](int) { stop_flag = 1; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
}

bool stop_requested() { return stop_flag != 0; }

}  // namespace pilotfish::apps
