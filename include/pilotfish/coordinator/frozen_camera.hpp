#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// Detects a camera that repeats the same picture with new stamps: a sensor's noise makes two pictures
/// differ even in the dark, unless every pixel is clipped, and then no leader is visible either.
///
/// Where pictures differ, as they nearly always do, a sample of 4096 words suffices; only if the sample is the same as
/// in the frame before is the whole picture read.
class FrozenCamera {
 public:
  /// From the third picture with the same pixels on. The view has passed check().
  bool is_frozen(const ImageView& image) noexcept;

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.seen_, self.next_);
  }

 private:
  static constexpr std::size_t kPictures = 16;  ///< more than a driver has buffers
  struct Seen {
    std::uint64_t sample = 0, whole = 0;
    std::uint64_t used = 0, whole_known = 0;  // not bool: padding would end up in a checkpoint
  };
  std::array<Seen, kPictures> seen_{};
  std::size_t next_ = 0;
};

}  // namespace pilotfish
PILOTFISH_API_END
