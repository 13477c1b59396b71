#include "driver.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <thread>

#include "line_reader.hpp"
#include "pilotfish/base/controller_link.hpp"
#include "pilotfish/base/serial_protocol.hpp"
#include "serial_port.hpp"
#include "stop_on_fault.hpp"

namespace pilotfish::apps {
namespace {

class PublishedDriver final : public Driver {
 public:
  void drive(const Twist& /*command*/, MonotonicTime /*now*/) override {}
  void poll(MonotonicTime /*now*/) override {}
  std::string trouble(MonotonicTime /*now*/) const override { return {}; }
};

constexpr std::int64_t kTryAgain_us = 1'000'000;
/// Shorter than this, a speed is mostly the rounding to whole ticks; counts that are passed over are in the next ones.
constexpr std::uint32_t kMeasureOver_ms = 20;

class SerialDriver final : public Driver {
 public:
  SerialDriver(std::string device, const base::BaseConfig& config)
      : device_(std::move(device)),
        config_(config),
        link_(config.serial.timeout_s),
        odometry_(config.wheels, config.limits.max_wheel_radps) {
    open();
  }
  SerialDriver(const SerialDriver&) = delete;
  SerialDriver& operator=(const SerialDriver&) = delete;
  ~SerialDriver() override { set_stop_on_fault_line(-1); }

  void drive(const Twist& command, MonotonicTime now) override {
    if (!port_) return;
    const base::SetPointLine line(link_.next_sequence(now), base::wheel_speeds(config_.wheels, command));
    try {
      switch (port_->write_newest(line.text())) {
        case SerialPort::Written::all: break;
        case SerialPort::Written::after_flush: ++counters_["serial_flushed"]; break;
        case SerialPort::Written::nothing: ++counters_["serial_blocked"]; break;
      }
    } catch (const SerialError& error) {
      lost(error.what(), now);
    }
  }

  void poll(MonotonicTime now) override {
    if (!port_ && now.us - lost_at_.us >= kTryAgain_us) try_again(now);
    if (!port_) return;
    const LineReader::Taken taken = reader_->take();
    for (const base::ControllerLine& line : taken.lines) on_line(line);
    rejected_ = taken.rejected;
    if (!taken.lost.empty()) lost(taken.lost, now);
  }

  std::string trouble(MonotonicTime now) const override {
    if (!port_) return device_ + " is gone: " + why_lost_;
    if (!link_.alive(now)) return "the controller on " + device_ + " does not answer";
    if ((faults_ & ~base::kFaultWatchdog) != 0) return std::string(base::first_fault(faults_ & ~base::kFaultWatchdog));
    return {};
  }
  bool emergency_stop() const override { return (faults_ & base::kFaultEmergencyStop) != 0; }

  std::optional<Measured> take_measured() override { return std::exchange(measured_, std::nullopt); }

  std::map<std::string, std::int64_t> counters() const override {
    std::map<std::string, std::int64_t> counters = counters_;
    for (const auto& [name, count] :
         {std::pair{"line_checksum_wrong", rejected_.checksum}, std::pair{"line_malformed", rejected_.malformed},
          std::pair{"line_too_long", rejected_.too_long}, std::pair{"line_cut_short", rejected_.cut_short},
          std::pair{"odometry_jump", odometry_.jumps()}})
      if (count > 0) counters[name] = count;
    return counters;
  }

  void drain() override {
    for (int i = 0; i < 50 && port_ && !port_->output_empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

 private:
  void open() {
    port_ = std::make_shared<SerialPort>(device_, config_.serial.baud);
    reader_ = std::make_unique<LineReader>(port_);
    set_stop_on_fault_line(port_->descriptor());
  }

  void lost(const std::string& why, MonotonicTime now) {
    set_stop_on_fault_line(-1);
    reader_.reset();
    port_.reset();
    lost_at_ = now;
    why_lost_ = why;
    faults_ = 0;
    ++counters_["serial_lost"];
    spdlog::error("{} is gone ({}); trying to open it again every second", device_, why);
  }

  void try_again(MonotonicTime now) {
    try {
      open();
    } catch (const SerialError& error) {
      lost_at_ = now;
      why_lost_ = error.what();
      return;
    }
    link_.reset();
    odometry_.forget();
    spdlog::info("{} is back", device_);
  }

  void on_line(const base::ControllerLine& line) {
    link_.echoed(line.sequence);
    if ((line.faults & base::kFaultWatchdog) != 0 && (faults_ & base::kFaultWatchdog) == 0)
      ++counters_["controller_watchdog"];
    faults_ = line.faults;
    if (measured_ms_ && line.encoders.time_ms - *measured_ms_ < kMeasureOver_ms) return;
    measured_ms_ = line.encoders.time_ms;
    if (const std::optional<Twist> twist = odometry_.update(line.encoders)) measured_ = {odometry_.pose(), *twist};
  }

  std::string device_;
  base::BaseConfig config_;
  base::ControllerLink link_;
  base::WheelOdometry odometry_;
  base::ControllerParser::Rejected rejected_;  ///< since the line was opened last
  std::shared_ptr<SerialPort> port_;
  std::unique_ptr<LineReader> reader_;
  MonotonicTime lost_at_;
  std::string why_lost_;
  std::uint16_t faults_ = 0;
  std::optional<std::uint32_t> measured_ms_;  ///< the controller's clock at the last reading that was used
  std::optional<Measured> measured_;
  std::map<std::string, std::int64_t> counters_;
};

}  // namespace

std::unique_ptr<Driver> published_driver() { return std::make_unique<PublishedDriver>(); }

std::unique_ptr<Driver> serial_driver(const std::string& device, const base::BaseConfig& config) {
  return std::make_unique<SerialDriver>(device, config);
}

}  // namespace pilotfish::apps
