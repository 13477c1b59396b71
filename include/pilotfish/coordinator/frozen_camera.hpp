#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pilotfish/api.hpp"
#include "pilotfish/core/frame.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// Whether a picture has been shown before.
enum class Repetition : std::uint8_t {
  none,      ///< something in it is new
  probable,  ///< the second with the same sample of its pixels: a driver that delivers twice, or the first of many
  certain,   ///< the third, or a later one, with the same pixels: the camera is frozen
};

/// Detects a camera that repeats the same picture with new stamps: a sensor's noise makes two pictures
/// differ even in the dark, unless every pixel is clipped, and then no leader is visible either.
///
/// Where pictures differ, as they nearly always do, a sample of 4096 words suffices; only if the sample is the same as
/// in one of the last 16 is the whole picture read. What the first of two had beyond its sample is then not known any
/// more, so the second is only probably the same.
class FrozenCamera {
 public:
  /// Of this picture among the last ones. The view has passed check().
  Repetition compare(const ImageView& image) noexcept;

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
