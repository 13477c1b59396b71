#include "pilotfish/coordinator/frozen_camera.hpp"

#include <algorithm>
#include <cstring>

namespace pilotfish {
namespace {

constexpr std::size_t kSampleWords = 4096;
constexpr std::size_t kWord = sizeof(std::uint64_t);

/// Bijective in `hash` for every `word`, so that two pictures which differ in one word never collide.
std::uint64_t mix(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x9E3779B97F4A7C15ULL;
  return hash ^ (hash >> 29);
}

/// Of every `step`th word of each row, and the odd bytes at its end.
std::uint64_t hash_rows(const ImageView& image, std::size_t step) {
  std::uint64_t hash = static_cast<std::uint64_t>(image.width) << 32 | static_cast<std::uint32_t>(image.height);
  const auto width = static_cast<std::size_t>(image.width);
  for (int v = 0; v < image.height; ++v) {
    const std::uint8_t* row = image.data + static_cast<std::size_t>(v) * static_cast<std::size_t>(image.stride_bytes);
    for (std::size_t u = 0; u < width; u += step * kWord) {
      std::uint64_t word = 0;
      std::memcpy(&word, row + u, std::min(kWord, width - u));
      hash = mix(hash, word);
    }
  }
  return hash;
}

}  // namespace

Repetition FrozenCamera::compare(const ImageView& image) noexcept {
  const std::size_t words = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) / kWord;
  const std::uint64_t sample = hash_rows(image, std::max<std::size_t>(words / kSampleWords, 1));
  auto* seen =
      std::find_if(seen_.begin(), seen_.end(), [&](const Seen& s) { return s.used != 0 && s.sample == sample; });
  if (seen == seen_.end()) {
    seen_[next_] = {sample, 0, 1, 0};
    next_ = (next_ + 1) % kPictures;
    return Repetition::none;
  }
  const std::uint64_t whole = hash_rows(image, 1);
  const Repetition repetition = seen->whole_known == 0 ? Repetition::probable
                                : whole == seen->whole ? Repetition::certain
                                                       : Repetition::none;
  seen->whole_known = 1;
  seen->whole = whole;
  return repetition;
}

}  // namespace pilotfish
