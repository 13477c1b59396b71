#pragma once

#include <cstdint>

#include "pilotfish/core/frame.hpp"

namespace pilotfish {

/// Notices a camera that gives the same picture again and again, with new stamps: a sensor's noise makes two pictures
/// differ even in the dark, unless every pixel is clipped, and then there is no leader to see either.
///
/// Where pictures differ, as they always do, a sample of 4096 words decides at once; only if the sample is the same as
/// in the frame before is the whole picture read.
class FrozenCamera {
 public:
  /// From the third picture in a row with the same pixels on. The view has passed check().
  bool is_frozen(const ImageView& image) noexcept;

 private:
  std::uint64_t sample_ = 0, whole_ = 0;
  bool any_ = false, whole_known_ = false;
};

}  // namespace pilotfish
