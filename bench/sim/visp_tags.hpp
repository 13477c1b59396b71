#pragma once

#include <visp3/core/vpCameraParameters.h>
#include <visp3/detection/vpDetectorAprilTag.h>

#include <Eigen/Geometry>
#include <map>
#include <optional>

#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/leader_body.hpp"

namespace pilotfish::bench {

/// The pose of a leader with vpDetectorAprilTag: detected on one thread, the pose of its largest tag by
/// HOMOGRAPHY_VIRTUAL_VS, then virtual visual servoing (vpPose) on the corners of all its tags at once. That is the
/// best that ViSP has for a body with several tags: two planes leave no doubt about the heading.
class VispTags {
 public:
  VispTags(const CameraModel& camera, const LeaderBody& body, double decimation);
  /// cMo; nothing if no tag of the body was found.
  std::optional<Eigen::Isometry3d> see(const vpImage<unsigned char>& picture);

 private:
  struct Tag {
    double size_m;
    Eigen::Isometry3d oMt;  ///< of ViSP's tag frame
  };
  vpDetectorAprilTag detector_;
  vpCameraParameters camera_;
  std::map<int, Tag> tags_;
  std::map<int, double> sizes_m_;
};

}  // namespace pilotfish::bench
