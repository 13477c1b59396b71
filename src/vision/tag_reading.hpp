#pragma once

#include "pilotfish/core/camera_model.hpp"
#include "pilotfish/core/frame.hpp"
#include "pilotfish/vision/tag_pattern.hpp"
#include "pilotfish/vision/tag_registration.hpp"

namespace pilotfish::vision {

/// The result of reading the cells of a template one by one.
struct TagReading {
  int bits = 0;               ///< of the code
  int outside_bits = 0;       ///< of these: outside the picture
  int unread_bits = 0;        ///< of these: inside, but without contrast around them, or of which the parts disagree
  int wrong_bits = 0;         ///< of these: nearer to the other colour
  int wrong_frame_cells = 0;  ///< of the rings that all tags of the family share
  int frame_cells = 0;
  /// Mean contrast of the bits, in gray levels: twice their distance from the middle gray, wrong ones negative.
  /// AprilTag's, which sharpens the picture first, is of the same size.
  double decision_margin = 0.0;
};

/// Reads the tag at the place given by the registration, with its levels, or if that leaves wrong cells, with those of
/// the cells around each (a shadow's edge, a reflection). Never throws.
TagReading read_tag(const ImageView& image, const CameraModel& camera, const TagPattern& pattern,
                    const Registration& registration) noexcept;

}  // namespace pilotfish::vision
