#pragma once

#include "luma.hpp"
#include "v4l2_device.hpp"

namespace pilotfish::capture {

/// What the driver agreed to.
struct GrantedFormat {
  PixelLayout layout;
  double frame_rate_hz = 0.0;  ///< 0: not reported by the driver
};

/// Requests the size, the best format (readable_formats()) in which the camera reaches the rate at this size, and
/// the rate. If it reaches the rate in none, the fastest is used. Throws CaptureError if it cannot give the size.
GrantedFormat negotiate(const V4l2Device& device, int width, int height, double frame_rate_hz);

}  // namespace pilotfish::capture
