#pragma once

#include <visp3/core/vpCameraParameters.h>
#include <visp3/core/vpImage.h>
#include <visp3/detection/vpDetectorAprilTag.h>
#include <visp3/robot/vpImageSimulator.h>

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/leader_body.hpp"

namespace pilotfish::bench {

/// A leader's tags as ViSP simulates and detects them: a vpImageSimulator for each, and one vpDetectorAprilTag. Pixel
/// centres are at +0.5 in vpDetectorAprilTag and at 0 in vpImageSimulator, so each gets its own principal point.
class VispWorld {
 public:
  /// camera: a pinhole. decimation: of the detector's quads.
  VispWorld(const CameraModel& camera, const LeaderBody& leader, double decimation);

  /// The picture from there, before even gray: tags on white sheets, sharp, without noise.
  const vpImage<unsigned char>& render(const Eigen::Isometry3d& cMo);

  /// The leader's base in the camera's frame, from the tag that is largest in the last picture.
  std::optional<Eigen::Isometry3d> detect();

 private:
  LeaderBody leader_;
  vpCameraParameters drawn_, detected_;
  vpImage<unsigned char> image_;
  std::vector<vpImageSimulator> sheets_;
  vpDetectorAprilTag detector_;
};

}  // namespace pilotfish::bench
