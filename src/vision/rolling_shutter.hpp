#pragma once

#include <optional>

#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "pilotfish/vision/tag_measurement.hpp"

namespace pilotfish::vision {

/// Where the body was when it was last measured, and how long before the present picture.
struct Before {
  Eigen::Isometry3d cMo;
  double since_s = 0.0;
};

/// The tags' corners as they were when the row in the middle of all of them was exposed; the tags themselves of a
/// camera whose rows are exposed at once. Without an earlier measurement the corners stay, and their covariance allows
/// for a motion that is not known. Never allocates.
///
/// Row v of H is exposed tau = readout (v - v_mid) / H after the middle row v_mid. A corner that is seen at p now and
/// was at q, one period T earlier, moves by (p - q) / (T + tau) px/s: its earlier row was the middle one of that
/// picture. So at the middle row's time it was at
///
///   p - tau (p - q) / (T + tau) = (1 - r) p + r q,      r = tau / (T + tau),
///
/// exact while it moves evenly. The covariance becomes (1 - r_i)(1 - r_j) C_ij + r_i r_j C_ij, if the earlier picture
/// was as good as this one. The pose is then that of the middle row's exposure. How long that is after the picture's
/// stamp depends on where the tags are in the picture; as a part of the latency it is learned.
TagMeasurements at_one_instant(const CameraModel& camera, const LeaderBody& body, const TagMeasurements& tags,
                               const std::optional<Before>& before) noexcept;

}  // namespace pilotfish::vision
