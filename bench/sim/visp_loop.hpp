#pragma once

#include "loop.hpp"
#include "visp_scene.hpp"
#include "visp_tags.hpp"

namespace pilotfish::bench {

/// vpImageSimulator and vpDetectorAprilTag in place of our pictures and our vision; our robots, our controller.
class VispLoop : public Loop {
 public:
  VispLoop(const std::string& name, const sim::Scenario& scenario, double decimation, bool bilinear);
  FrameFigures play(int frame) override;

 private:
  sim::World world_;  ///< its robots drive; its cameras are not asked
  Follower follower_;
  Coordinator coordinator_;
  VispScene scene_;
  VispTags tags_;
};

}  // namespace pilotfish::bench
