// Plays the threads around pilotfish-coordinator's sender of commands, inbox and simulated clock, line by line from
// stdin, and prints what comes out of them:
//   clock UTIME REAL_US                      -> clock NOW_US
//   frame AT_US | setpoint COUNTER | wake        put into the inbox
//   later WHAT                               the same (`frame`, `setpoint` or `wake`), by another thread a moment later
//   take PATIENCE_US                         -> taken FRAME_AT_US|none ELAPSED_US COUNTER...
//   inbox                                    -> inbox OVERTAKEN FORGOTTEN
//   sender FRAME_RATE_HZ MAX_AGE_S SIMULATED RECORDS
//   answer UTIME LINEAR STATUS REASON LIFE_US HOLDING   -> answer LINEAR STATUS REASON; from now on for LIFE_US
//   again UTIME | setpoint_changed HOLDING RUN STOPS | stop | rival AGO_US | finish REASON
//   base SESSION AHEAD_US                    a base of that session announces itself, its clock so much ahead of ours
//   wait N                                   until N more commands have left by themselves, 5 s at most
//   counts                                   -> counts SENT MISSED RIVALS LATE STOPS BEATS_RISE
// and, for every command that leaves,
//   sent COUNTER UTIME LINEAR STATUS REASON SESSION BASE_SESSION SIMULATED SINCE_ANSWER_US VALID_AFTER_ANSWER_US|0
//   recorded COUNTER HOLDING RUN STATUS REASON MISSING ASKED_LATER_US
#include <chrono>
#include <iostream>
#include <numeric>
#include <sstream>
#include <string>
#include <thread>

#include "command_sender.hpp"
#include "inbox.hpp"
#include "simulated_clock.hpp"

namespace {

using namespace pilotfish;
using namespace pilotfish::apps;

constexpr std::int64_t kSession = 77, kPatience_us = 5'000'000;

struct Player {
  std::istringstream words;
  std::mutex mutex;  // of what follows: the sender's thread publishes, too
  std::ostringstream out;
  std::int64_t left = 0;
  MonotonicTime answered_at;

  Inbox inbox;
  SimulatedClock clock;
  std::vector<std::thread> others;
  std::optional<CommandSender> sender;

  template <class Value>
  Value next() {
    Value value{};
    words >> value;
    return value;
  }
  template <class... Values>
  void print(const Values&... values) {
    const std::lock_guard lock(mutex);
    ((out << values << ' '), ...) << '\n';
  }
  std::int64_t has_left() {
    const std::lock_guard lock(mutex);
    return left;
  }

  void put(const std::string& what) {
    if (what == "frame")
      inbox.put({{next<std::int64_t>()}, nullptr, nullptr});
    else if (what == "setpoint")
      inbox.put(ReceivedSetpoint{{}, next<std::int64_t>(), 0});
    else
      inbox.wake();
  }
  void take() {
    const MonotonicTime begin = monotonic_now();
    const Inbox::Taken taken = inbox.take(std::chrono::microseconds(next<std::int64_t>()));
    std::string line = taken.frame ? std::to_string(taken.frame->at.us) : "none";
    line += " " + std::to_string(monotonic_now().us - begin.us);
    for (const Received& received : taken.received)
      line += " " + std::to_string(std::get<ReceivedSetpoint>(received).counter);
    print("taken", line);
  }

  void begin_sender() {
    SenderConfig config;
    config.session = kSession;
    config.frame_rate_hz = next<double>();
    config.max_age_s = next<double>();
    config.simulated = next<bool>();
    if (next<bool>())
      config.record = [this](const HeldCommand& held, MonotonicTime asked_at, Reason missing, const HeldAnswer& sent,
                             std::int64_t counter) {
        print("recorded", counter, held.holding, held.run, static_cast<int>(sent.status), static_cast<int>(sent.reason),
              static_cast<int>(missing), asked_at.us - monotonic_now().us);
      };
    sender.emplace(config, [this](const bus::CommandReport& report) {
      const std::int64_t since_us = monotonic_now().us - answered_at.us;
      const std::lock_guard lock(mutex);
      ++left;
      out << "sent " << report.counter << ' ' << report.utime << ' ' << report.command.linear_mps << ' '
          << static_cast<int>(report.status) << ' ' << static_cast<int>(report.reason) << ' ' << report.session << ' '
          << report.base_session << ' ' << report.simulated << ' ' << since_us << ' '
          << (report.valid_until_us == 0 ? 0 : report.valid_until_us - answered_at.us) << '\n';
    });
  }
  void answer() {
    StepResult result;
    HeldCommand held;
    result.utime = held.utime = next<std::int64_t>();
    result.command.linear_mps = held.command.linear_mps = next<double>();
    result.status = static_cast<Status>(next<int>());
    result.reason = static_cast<Reason>(next<int>());
    const auto life_us = next<std::int64_t>();
    held.holding = next<bool>();
    held.ever_measured = true;
    held.from = answered_at = monotonic_now();
    held.until = {answered_at.us + life_us};
    const HeldAnswer sent = sender->answer(result, held, result.utime);
    print("answer", sent.command.linear_mps, static_cast<int>(sent.status), static_cast<int>(sent.reason));
  }
  void setpoint_changed() {
    HeldCommand held;
    held.holding = next<bool>();
    held.run = next<bool>();
    sender->setpoint_changed(held, next<std::int64_t>());
  }
  void wait() {
    const std::int64_t enough = has_left() + next<std::int64_t>();
    const MonotonicTime begin = monotonic_now();
    while (has_left() < enough && monotonic_now().us - begin.us < kPatience_us)
      std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  void counts() {
    const SenderCounts counts = sender->counts();
    const auto& late = counts.lateness.counts();
    print("counts", sender->sent(), counts.missed_deadlines, counts.rivals_heard,
          std::accumulate(late.begin(), late.end(), 0), sender->stops_received(), sender->beats() > 0);
  }

  void play(const std::string& line) {
    words = std::istringstream(line);
    const auto what = next<std::string>();
    if (what == "clock") {
      const auto utime = next<std::int64_t>();
      const MonotonicTime now = clock.at(utime, {next<std::int64_t>()});
      print("clock", now.us, clock.now() == now);
    } else if (what == "later") {
      others.emplace_back([this, later = next<std::string>(), rest = next<std::string>()] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        if (later == "frame")
          inbox.put({{std::stoll(rest)}, nullptr, nullptr});
        else if (later == "setpoint")
          inbox.put(ReceivedSetpoint{{}, std::stoll(rest), 0});
        else
          inbox.wake();
      });
    } else if (what == "take") {
      take();
    } else if (what == "inbox") {
      print("inbox", inbox.overtaken(), inbox.forgotten());
    } else if (what == "sender") {
      begin_sender();
    } else if (what == "answer") {
      answer();
    } else if (what == "again") {
      sender->answer_again(next<std::int64_t>());
    } else if (what == "setpoint_changed") {
      setpoint_changed();
    } else if (what == "stop") {
      print("stop", sender->stop_received());
    } else if (what == "rival") {
      sender->rival_command_received({monotonic_now().us - next<std::int64_t>()});
    } else if (what == "base") {
      const auto session = next<std::int64_t>();
      const auto ahead = next<std::string>();
      sender->base_report_received(session, ahead == "none" ? 0 : monotonic_now().us + std::stoll(ahead));
    } else if (what == "finish") {
      sender->finish(static_cast<Reason>(next<int>()));
    } else if (what == "wait") {
      wait();
    } else if (what == "counts") {
      counts();
    } else {
      put(what);
    }
  }
};

}  // namespace

int main() {
  Player player;
  for (std::string line; std::getline(std::cin, line);) player.play(line);
  for (std::thread& other : player.others) other.join();
  player.sender.reset();
  std::cout << player.out.str();
}
