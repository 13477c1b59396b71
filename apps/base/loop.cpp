#include "loop.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "pilotfish/core/monotonic.hpp"
#include "stop_signal.hpp"

namespace pilotfish::apps {
namespace {

/// Another base of this name sends 20 times a second or more. A base that starts while it runs receives it in this
/// time.
constexpr std::int64_t kListenFirst_us = 300'000;
/// Two that start together receive each other's a little later.
constexpr std::int64_t kYoung_us = 3'000'000;
/// Not more lines to the wheels than this, at any rate of commands; zeros excepted.
constexpr std::int64_t kBetweenLines_us = 4'000;
constexpr std::int64_t kBetweenLogs_us = 200'000;
constexpr std::int64_t kBetweenRefusalLogs_us = 5'000'000;
constexpr std::int64_t kBetweenSummaries_us = 2'000'000;

bus::BaseReport::State on_the_wire(base::BaseState state) {
  switch (state) {
    case base::BaseState::waiting: return bus::BaseReport::State::waiting;
    case base::BaseState::driving: return bus::BaseReport::State::driving;
    case base::BaseState::stopped: return bus::BaseReport::State::stopped;
    case base::BaseState::fault: break;
  }
  return bus::BaseReport::State::fault;
}

class Loop {
 public:
  Loop(const BaseLoopConfig& config, base::Base& base, Driver& driver, bus::Bus& bus, ServiceNotify& service)
      : config_(config),
        base_(base),
        driver_(driver),
        bus_(bus),
        service_(service),
        period_us_(static_cast<std::int64_t>(1e6 / config.rate_hz)),
        started_(monotonic_now()),
        summarised_(started_) {
    bus_.on_base(config_.robot, [this](const bus::BaseReport& report) { receive(report); });
    bus_.on_command(config_.robot, [this](const bus::CommandReport& report) { receive(report); });
    bus_.on_setpoint(config_.robot, [this](const bus::SetpointReport& report) { receive(report); });
  }

  void run() {
    const MonotonicTime begin{started_.us + kListenFirst_us};
    while (!stop_requested()) {
      wait();
      const MonotonicTime now = monotonic_now();
      if (another_) throw AnotherBase("another pilotfish-base is running for " + config_.robot + " on " + bus_.url());
      driver_.poll(now);
      if (!publish_ && begin <= now) {
        publish_ = true;
        service_.ready("wheels of " + config_.robot);
      }
      step(now);
      service_.progress(now);
    }
    service_.stopping();
    end();
  }

 private:
  void receive(const bus::BaseReport& report) {
    if (report.session == base_.session()) return;
    ++foreign_bases_;
    const std::int64_t age_us = monotonic_now().us - started_.us;
    // Of two that begin together, the one with the smaller number stays.
    if (age_us < kListenFirst_us || (age_us < kYoung_us && report.session < base_.session())) another_ = true;
  }
  /// Only these two statuses may move a robot, whatever else the message says; and a search for the leader may turn it
  /// in place.
  static Twist movable(const bus::CommandReport& report) {
    if (report.status == Status::tracking || report.status == Status::coasting) return report.command;
    const bool searches = report.status == Status::lost && report.reason == Reason::turning_to_search;
    return searches ? Twist{0.0, report.command.angular_radps} : Twist{};
  }
  void receive(const bus::CommandReport& report) {
    const base::ReceivedCommand command{report.session,          report.counter,  report.base_session,
                                        {report.valid_until_us}, movable(report), report.simulated};
    if (base_.receive(command, bus_.arrival(), monotonic_now()) != base::CommandVerdict::accepted) return;
    fresh_ = true;
    ++accepted_;
  }
  void receive(const bus::SetpointReport& report) {
    const base::ReceivedSetpoint setpoint{report.session, report.counter, report.setpoint.run};
    const base::LatchVerdict verdict = base_.receive(setpoint, monotonic_now());
    if (verdict == base::LatchVerdict::resumed) spdlog::info("resumed by session {:x}", report.session);
  }

  /// Until a message comes, the next period begins, or the last good command gets too old.
  void wait() {
    std::int64_t until_us = next_period_.us;
    if (const auto deadline = base_.deadline()) until_us = std::min(until_us, deadline->us);
    const std::int64_t left_us = until_us - monotonic_now().us;
    if (left_us > 0 && left_us < 1000) {  // the bus counts in whole milliseconds
      const timespec rest{0, static_cast<long>(left_us) * 1000};
      nanosleep(&rest, nullptr);
    }
    bus_.handle(static_cast<int>(std::max<std::int64_t>(left_us / 1000, 0)));
  }

  void step(MonotonicTime now) {
    if (driver_.emergency_stop()) base_.receive(base::ReceivedSetpoint{0, 0, false}, now);
    const std::string trouble = driver_.trouble(now);
    base_.driver_works(trouble.empty());
    const base::BaseOutput output = base_.step(now);
    const bool changed = output.state != last_.state || output.accepted_session != last_.accepted_session ||
                         (output.command == Twist{} && !(last_command_ == Twist{}));
    const bool due = next_period_ <= now;
    if (due || changed || (fresh_ && now.us - last_line_.us >= kBetweenLines_us)) send(output, now);
    if (const auto measured = driver_.take_measured()) receive(*measured);
    if (due || changed) report(output, trouble);
    if (changed) log(output, trouble, now);
    log_refusals(now);
    log_summary(output, now);
    last_ = output;
    if (due) next_period_ = {std::max(next_period_.us + period_us_, now.us)};
  }

  void send(const base::BaseOutput& output, MonotonicTime now) {
    driver_.drive(output.command, now);
    last_command_ = output.command;
    last_line_ = now;
    fresh_ = false;
  }

  void receive(const Measured& measured) {
    measured_ = measured.twist;
    if (!publish_) return;
    bus_.publish(config_.robot, bus::PoseReport{wall_utime(), measured.pose.x_m, measured.pose.y_m,
                                                measured.pose.heading_rad, measured.twist});
  }

  void report(const base::BaseOutput& output, const std::string& trouble) {
    if (!publish_) return;
    bus::BaseReport report;
    report.utime = wall_utime();
    report.session = base_.session();
    report.counter = ++counter_;
    report.monotonic_us = monotonic_now().us;
    report.accepted_session = output.accepted_session;
    report.command = output.command;
    report.measured = std::exchange(measured_, std::nullopt);
    report.stopped = base_.stopped();
    report.state = on_the_wire(output.state);
    report.text = std::string(to_string(output.state)) + (trouble.empty() ? "" : ": " + trouble);
    report.rejected = refusals();
    bus_.publish(config_.robot, report);
  }

  bus::Counters refusals() const {
    bus::Counters counters = base_.rejected();
    for (const auto& [name, count] : bus_.rejected()) counters[name] += count;
    for (const auto& [name, count] : driver_.counters()) counters[name] += count;
    if (foreign_bases_ > 0) counters["another_base"] = foreign_bases_;
    return counters;
  }

  /// A state that keeps changing must not fill a disk.
  void log(const base::BaseOutput& output, const std::string& trouble, MonotonicTime now) {
    if (output.state == logged_state_ && output.accepted_session == logged_session_) return;
    if (now.us - logged_.us < kBetweenLogs_us) return;
    logged_ = now;
    logged_state_ = output.state;
    logged_session_ = output.accepted_session;
    service_.status(trouble.empty() ? to_string(output.state) : trouble);
    if (!trouble.empty()) {
      spdlog::error("{}: {}", to_string(output.state), trouble);
    } else if (output.accepted_session != 0) {
      spdlog::info("{}, accepted session {:x}", to_string(output.state), output.accepted_session);
    } else {
      spdlog::info("{}, no session accepted", to_string(output.state));
    }
  }

  void log_refusals(MonotonicTime now) {
    if (now.us - refusals_logged_.us < kBetweenRefusalLogs_us) return;
    refusals_logged_ = now;
    const bus::Counters counters = refusals();
    if (counters == logged_refusals_) return;
    std::string text;
    for (const auto& [name, count] : counters) text += " " + name + " " + std::to_string(count);
    spdlog::warn("refused or lost so far:{}", text);
    logged_refusals_ = counters;
  }

  void log_summary(const base::BaseOutput& output, MonotonicTime now) {
    const std::int64_t passed_us = now.us - summarised_.us;
    if (!config_.summary || passed_us < kBetweenSummaries_us) return;
    spdlog::info("{}: v {:.3f} m/s, w {:.3f} rad/s; {} commands accepted in {:.1f} s", to_string(output.state),
                 output.command.linear_mps, output.command.angular_radps, accepted_,
                 static_cast<double>(passed_us) * 1e-6);
    summarised_ = now;
    accepted_ = 0;
  }

  /// Zeros are the last lines to the wheels; three times, because a line or a datagram may be lost.
  void end() {
    service_.stopping();
    publish_ = true;
    const base::BaseOutput zeros{base::BaseState::waiting, {}, 0};
    for (int i = 0; i < 3; ++i) {
      driver_.drive({}, monotonic_now());
      report(zeros, "this process has ended");
      driver_.drain();
    }
  }

  const BaseLoopConfig config_;
  base::Base& base_;
  Driver& driver_;
  bus::Bus& bus_;
  ServiceNotify& service_;
  const std::int64_t period_us_;
  const MonotonicTime started_;
  MonotonicTime next_period_;
  MonotonicTime last_line_;
  bool publish_ = false;  ///< not before it is known that no other base does
  bool another_ = false;
  bool fresh_ = false;  ///< a good command has come since the last line
  std::int64_t counter_ = 0, foreign_bases_ = 0;
  std::int64_t accepted_ = 0;  ///< commands since the last summary
  base::BaseOutput last_;
  Twist last_command_;
  std::optional<Twist> measured_;
  MonotonicTime logged_, refusals_logged_, summarised_;
  std::optional<base::BaseState> logged_state_;
  std::int64_t logged_session_ = 0;
  bus::Counters logged_refusals_;
};

}  // namespace

void base_loop(const BaseLoopConfig& config, base::Base& base, Driver& driver, bus::Bus& bus, ServiceNotify& service) {
  try {
    Loop(config, base, driver, bus, service).run();
  } catch (...) {
    driver.drive({}, monotonic_now());
    driver.drain();
    throw;
  }
}

}  // namespace pilotfish::apps
