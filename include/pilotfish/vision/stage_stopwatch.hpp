#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "pilotfish/api.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::vision {

/// What is done on the way from a frame to an observation, in this order; detect only if nothing is followed.
enum class Stage : std::uint8_t {
  predict,  ///< the positions of the leader and of each of its tags
  detect,   ///< where a detector finds tags, in the region or in the frame
  search,   ///< slide each template to its best match
  align,    ///< fit it: the registration
  read,     ///< its bits, and the gates
  pose,     ///< one pose from all tags, or two
  heading,  ///< plausible? and the heading filter
};
inline constexpr std::size_t kStages = 7;

std::string_view to_string(Stage stage) noexcept;

/// How long each stage took, of one frame. The caller provides the clock: this module has none of its own, and
/// without one nothing is measured. Times influence no result.
class StageStopwatch {
 public:
  using Clock = std::int64_t (*)() noexcept;  ///< nanoseconds since any moment, never running backwards

  explicit StageStopwatch(Clock clock = nullptr) : clock_(clock) {}  ///< no clock: all times stay zero

  /// All times are zero; time counts from here on.
  void start() noexcept {
    if (clock_ == nullptr) return;
    ns_ = {};
    last_ns_ = clock_();
  }
  /// Adds the time since the last call to `stage`.
  void lap(Stage stage) noexcept {
    if (clock_ == nullptr) return;
    const std::int64_t now_ns = clock_();
    ns_[static_cast<std::size_t>(stage)] += now_ns - last_ns_;
    last_ns_ = now_ns;
  }

  bool runs() const { return clock_ != nullptr; }                                      ///< has a clock
  std::int64_t ns(Stage stage) const { return ns_[static_cast<std::size_t>(stage)]; }  ///< [ns], of all tags together

 private:
  Clock clock_;
  std::int64_t last_ns_ = 0;
  std::array<std::int64_t, kStages> ns_{};
};

}  // namespace pilotfish::vision
PILOTFISH_API_END
