// Random calls of the coordinator, checked against the one rule by bookkeeping of its own: a command that is not zero
// needs a measurement that arrived at most 100 ms ago, and no stop since. Prints what was counted as JSON.
//
//   random-steps CONFIG COUNT SEED

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <iterator>
#include <optional>

#include "pilotfish/config/files.hpp"
#include "pilotfish/coordinator/coordinator.hpp"
#include "random_numbers.hpp"

namespace {

using namespace pilotfish;

struct Book {
  std::deque<std::int64_t> arrived_us;  ///< of the last calls that were given an observation
  bool run = true;
  std::int64_t steps = 0, moving = 0, tracked = 0, violations = 0;

  void measured(std::int64_t now_us) {
    arrived_us.push_back(now_us);
    if (arrived_us.size() > 32) arrived_us.pop_front();
  }
  void check(const Twist& command, std::int64_t now_us) {
    if (!std::isfinite(command.linear_mps) || !std::isfinite(command.angular_radps)) ++violations;
    if (command == Twist{}) return;
    ++moving;
    const bool fresh = std::any_of(arrived_us.begin(), arrived_us.end(), [&](std::int64_t arrival_us) {
      return now_us >= arrival_us && now_us - arrival_us <= 100'000;
    });
    if (!run || !fresh) ++violations;
  }
};

class Stamps {
 public:
  explicit Stamps(std::uint64_t seed) : random_(seed) {}

  std::int64_t next(std::int64_t passed_us) {
    switch (random_.below(24)) {
      case 0: return last_;  // repeated
      case 1:
        return last_ - static_cast<std::int64_t>(random_.below(1'000'000));  // backward, and later ones from there
      case 2: return wild();
      case 3: last_ = wild(); return last_;  // the clock is set
      case 4: last_ += static_cast<std::int64_t>(random_.bits() % 7'200'000'000) - 3'600'000'000; return last_;
      case 5: return last_ + static_cast<std::int64_t>(random_.below(10'000'000));
      case 6: last_ -= 33'333; return last_;
      case 7: last_ += 33; return last_;
      default:
        // Of a sound source, which is most of the time; wraps where the clock ends.
        last_ = static_cast<std::int64_t>(static_cast<std::uint64_t>(last_) + static_cast<std::uint64_t>(passed_us));
        return last_;
    }
  }

 private:
  std::int64_t wild() {
    const std::uint64_t bits = random_.bits();
    switch (random_.below(4)) {
      case 0: return static_cast<std::int64_t>(bits);
      case 1: return std::int64_t{1} << 62;
      case 2: return -(std::int64_t{1} << 62);
      default: return static_cast<std::int64_t>(bits % 2'000'000'000'000'000);
    }
  }
  probes::RandomNumbers random_;
  std::int64_t last_ = 1'000'000;
};

vision::ObservationResult sight(probes::RandomNumbers& random, std::int64_t utime) {
  vision::ObservationResult sight;
  if (random.below(3) == 0) {
    sight.reason = Reason::no_tag_found;
    return sight;
  }
  Observation& observation = sight.observation.emplace();
  observation.utime = utime;
  observation.distance_m = 0.5 + 4.0 * random.between(0.0, 1.0);
  observation.bearing_rad = random.between(0.0, 1.0) - 0.5;
  observation.heading_rad = 2.0 * random.between(0.0, 1.0) - 1.0;
  observation.covariance = Eigen::Vector3d(1e-6, 1e-6, 1e-4).asDiagonal();
  observation.measured = {{observation.distance_m, observation.bearing_rad, observation.heading_rad},
                          observation.covariance};
  return sight;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 64;
  const CoordinatorConfig config = config::load_coordinator(argv[1]).coordinator;
  std::optional<Coordinator> coordinator(config);
  std::int64_t epochs = 0;
  bool ages_known = true;
  const std::int64_t count = std::atoll(argv[2]);
  probes::RandomNumbers random(std::strtoull(argv[3], nullptr, 10));
  Stamps stamps(random.bits());
  Book book;
  std::int64_t now_us = 1'000'000'000;
  for (; book.steps < count; ++book.steps) {
    constexpr std::int64_t kSteps_us[] = {0,      1,      1'000,  10'000,  33'333,   33'333,
                                          33'333, 33'333, 99'999, 100'001, 1'000'000};
    const std::int64_t passed_us = kSteps_us[random.below(static_cast<int>(std::size(kSteps_us)))];
    now_us += passed_us;
    if (random.below(5'000) == 0) {  // it starts anew: what it has learnt of the clocks holds for good
      epochs += coordinator->clock_epochs();
      coordinator.emplace(config);
      book.run = config.setpoint.run;
      book.arrived_us.clear();
      ages_known = random.below(2) == 0;
    }
    if (random.below(200) == 0) {
      Setpoint setpoint = coordinator->setpoint();
      setpoint.run = random.below(3) != 0;
      if (coordinator->set_setpoint(setpoint)) book.run = setpoint.run;
    }
    const std::int64_t utime = stamps.next(passed_us);
    const std::int64_t known_age_us =
        ages_known && random.below(10) == 0 ? static_cast<std::int64_t>(random.bits()) >> random.below(64) : 0;
    const vision::ObservationResult seen = sight(random, utime);
    if (seen.observation) book.measured(now_us);
    const StepResult result = coordinator->step_observation(utime, seen, {now_us}, known_age_us);
    if (result.status == Status::tracking) ++book.tracked;
    book.check(result.command, now_us);
    // What a sender would ask afterwards, at any time.
    const std::int64_t later_us = now_us + static_cast<std::int64_t>(random.below(250'000)) - 20'000;
    book.check(coordinator->command_at({later_us}).command, later_us);
  }
  std::printf("{\"steps\": %lld, \"moving\": %lld, \"tracked\": %lld, \"epochs\": %lld, \"violations\": %lld}\n",
              static_cast<long long>(book.steps), static_cast<long long>(book.moving),
              static_cast<long long>(book.tracked), static_cast<long long>(epochs + coordinator->clock_epochs()),
              static_cast<long long>(book.violations));
  return book.violations == 0 ? 0 : 1;
}
