#pragma once

#include <map>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "log_throttle.hpp"
#include "pilotfish/bus/bus.hpp"
#include "pilotfish/sim/recorder.hpp"
#include "pilotfish/sim/world.hpp"

namespace pilotfish::apps {

/// A coordinator that does not answer; the message names it, and what to check.
class NoAnswer : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct RunSummary {
  int frames = 0;        ///< exposures
  int delivered = 0;     ///< pictures that went out, over all robots
  int dropped = 0;       ///< pictures that the scenario's seed dropped
  int sent_again = 0;    ///< pictures that had to be sent once more
  int skipped = 0;       ///< exposures that real time left no time for
  bool stopped = false;  ///< by a signal
};

struct RunnerConfig {
  bool publish_intent = false;  ///< leaders publish their intent
  std::size_t threads = 1;      ///< that render pictures, one each; the pictures are the same with any number
  bool driven_by_base = false;  ///< wheels execute NAME_BASE instead of NAME_COMMAND; in real time only
};

/// A world on the bus. One of the two play functions is called once.
class Runner {
 public:
  /// `csv` may be nullptr; else it outlives the runner.
  Runner(sim::World& world, bus::Bus& bus, double wait_s, std::ostream* csv, const RunnerConfig& config);

  /// Exposure by exposure: pictures out, wait for the command that answers each (its utime is the picture's),
  /// let it act one latency after the exposure, go on. Throws NoAnswer.
  RunSummary play_in_lockstep();
  /// At the pace of the monotonic clock. A picture leaves one latency after its exposure; a command acts when it comes.
  RunSummary play_in_real_time();

 private:
  void publish_poses();
  /// How each leader moves now or, `until_delivery`, when the first picture that is exposed now reaches a follower: in
  /// lock-step that takes no time, and on a robot it does.
  void publish_motions(bool until_delivery);
  void publish_ranges();  ///< before the pictures of the same instant
  void publish_image(const std::string& robot, const Frame& frame);
  /// The picture of each of followers_; nothing where the camera drops it.
  std::vector<std::optional<Frame>> expose();
  double latency_s(const std::string& robot) const;
  double arrived_after(double start_s) const;
  void wait_until_all_are_heard();
  void obey_bases(const double& start_s);
  /// As a motor controller does: wheels without a command for 100 ms stand still.
  void stop_unattended_wheels(double now_s);
  void expose_all();
  void deliver(double now_s);
  void record();
  void report_progress();
  void report_failures();
  double exposure_s(int frame) const { return frame / world_.scenario().frame_rate_hz; }

  sim::World& world_;
  bus::Bus& bus_;
  double wait_s_;
  std::ostream* csv_;
  bool driven_by_base_;
  std::size_t threads_;
  std::map<std::string, double> commanded_s_;  ///< world's time of a base's last command to a robot's wheels
  std::vector<std::string> followers_;
  std::map<std::string, double>
      with_intent_;  ///< leaders that publish their intent, and their followers' least latency [s]
  struct UnderWay {  // a picture between its exposure and its delivery
    double due_s;
    std::string robot;
    Frame frame;
  };
  std::vector<UnderWay> under_way_;
  std::map<std::string, sim::Answer> answers_;  ///< the last of each follower
  double last_progress_s_ = 0.0;                ///< on the monotonic clock
  std::int64_t failed_ = 0;                     ///< messages that could not be sent, already logged
  LogThrottle throttle_{10.0};
  RunSummary played_;
};

}  // namespace pilotfish::apps
