#pragma once

#include <visp3/core/vpCameraParameters.h>
#include <visp3/core/vpImage.h>
#include <visp3/robot/vpImageSimulator.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "pilotfish/sim/renderer.hpp"

namespace pilotfish::bench {

/// One robot's body as vpImageSimulator draws it: one plane for each surface that our own renderer draws, of the same
/// corners, grays and tag cells.
///
/// What our renderer adds to a picture and vpImageSimulator has not is added here at the least cost that is known: a
/// finished picture of the background, which does not turn, OpenCV's blur, noise that was drawn beforehand, and a table
/// for the sensor's response. There is no lens and no shot noise.
class VispScene {
 public:
  VispScene(const std::vector<sim::Surface>& surfaces, const CameraModel& camera,
            const sim::Imperfections& imperfections, const std::vector<std::uint8_t>& background, bool bilinear);

  /// The picture of the body at cMo, which is overwritten by the next call.
  const vpImage<unsigned char>& picture(const Eigen::Isometry3d& cMo, std::uint64_t noise_seed);

 private:
  struct Plane {
    vpImageSimulator simulator{vpImageSimulator::GRAY_SCALED};
    Eigen::Vector3d centre_m;
    bool is_sheet = false;
  };
  void disturb(std::uint64_t noise_seed);

  vpCameraParameters camera_;
  sim::Imperfections imperfections_;
  vpImage<unsigned char> background_, picture_;
  std::vector<Plane> planes_;
  std::vector<std::int16_t> noise_;      ///< a picture's and some more, so that each can begin elsewhere
  std::vector<unsigned char> response_;  ///< of gray + 256
};

}  // namespace pilotfish::bench
