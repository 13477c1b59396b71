#pragma once

#include "loop.hpp"

namespace pilotfish::bench {

/// sim::World and Coordinator, with the calls that pilotfish.harness makes.
class OurLoop : public Loop {
 public:
  explicit OurLoop(const sim::Scenario& scenario);
  FrameFigures play(int frame) override;

 private:
  sim::World world_;
  Follower follower_;
  Coordinator coordinator_;
};

}  // namespace pilotfish::bench
