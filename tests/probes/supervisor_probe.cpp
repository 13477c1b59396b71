// Plays pilotfish-coordinator's main thread before a supervisor, with a sender of commands that sends nowhere, as its
// arguments say, one after the other:
//   ready=SOURCE | ended | fail=PROBLEM      what main() and the threads say to it
//   look=MS                                  turns of the control loop every 5 ms, for so long
//   idle=MS                                  no turn for so long
//   hold | release                           the sender is stuck in publishing, and goes on
//   take                                     waits for the inbox, 20 s at most
// Prints "VERB AT_US" as each begins (monotonic clock), "sent STATUS REASON" for each command, and "end STOP_REQUESTED
// FAILED" if it is not ended before.
#include <spdlog/spdlog.h>

#include <chrono>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>

#include "command_sender.hpp"
#include "inbox.hpp"
#include "stop_signal.hpp"
#include "supervisor.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::apps;

std::mutex printing;

template <class... Values>
void print(const Values&... values) {
  const std::lock_guard lock(printing);
  ((std::cout << values << ' '), ...) << std::endl;
}

void wait_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

}  // namespace

int main(int argc, char** argv) {
  block_stop_signals();  // before the first thread, as main() does
  spdlog::set_level(spdlog::level::off);
  std::mutex bus;
  Inbox inbox;
  CommandSender sender({77, 30.0, 0.1, false, nullptr}, [&](const bus::CommandReport& report) {
    const std::lock_guard lock(bus);
    print("sent", static_cast<int>(report.status), static_cast<int>(report.reason));
  });
  Supervisor supervisor(sender, inbox);
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    const std::size_t equals = argument.find('=');
    const std::string verb = argument.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : argument.substr(equals + 1);
    const MonotonicTime begin = monotonic_now();
    print(verb, begin.us);
    if (verb == "ready") {
      supervisor.ready(value);
    } else if (verb == "ended") {
      supervisor.ended();
    } else if (verb == "fail") {
      supervisor.fail(value);
    } else if (verb == "look") {
      while (monotonic_now().us - begin.us < 1000 * std::stoll(value)) {
        supervisor.looked();
        wait_ms(5);
      }
    } else if (verb == "idle") {
      wait_ms(std::stoi(value));
    } else if (verb == "hold") {
      bus.lock();
    } else if (verb == "release") {
      bus.unlock();
    } else if (verb == "take") {
      inbox.take(std::chrono::seconds(20));
    } else {
      return 64;
    }
  }
  print("end", supervisor.stop_requested(), supervisor.failed());
}
