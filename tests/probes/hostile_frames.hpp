#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/core/leader_body.hpp"
#include "random_numbers.hpp"

namespace pilotfish::probes {

/// A camera of any size and calibration that CameraModel::validate() lets pass, sane or not.
CameraModel any_camera(RandomNumbers& random);

/// 1 to 12 tags of one family, anywhere on the body, of any size from 1 cm to 1 m.
LeaderBody any_body(RandomNumbers& random);

/// A camera of that size that could have been built, through which pictures can be rendered.
CameraModel plain_camera(int width, int height);

/// Pixels in a buffer that ends where the picture ends, so that whoever reads on is caught.
struct Picture {
  std::vector<std::uint8_t> bytes;
  int width = 0, height = 0, stride_bytes = 0;
};

/// What the camera would see of the leader somewhere before it; now and then with rows longer than the picture.
Picture with_leader(const LeaderBody& body, const CameraModel& plain, RandomNumbers& random);

/// Noise, nothing, or patterns full of edges, in that size.
Picture without_sense(int width, int height, RandomNumbers& random);

/// The same pixels, disturbed: noise, a patch over them, the negative, shifted so that the rim cuts tags.
void disturb(Picture& picture, RandomNumbers& random);

/// The frame that claims to hold the picture; now and then it claims more than there is.
Frame claimed(Picture picture, std::int64_t utime, RandomNumbers& random);

}  // namespace pilotfish::probes
