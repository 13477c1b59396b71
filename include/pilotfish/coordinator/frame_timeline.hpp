#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/monotonic.hpp"
#include "pilotfish/core/status.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish {

/// The check of a frame's stamp.
struct StampVerdict {
  Reason reason = Reason::none;  ///< none: in order and fresh
  bool new_epoch = false;        ///< the source's clock was set; earlier measurements are unrelated to this stamp
  std::int64_t age_us = 0;       ///< known to have passed from the exposure to the arrival, never negative
};

/// Stamps order the frames and give the time between two of them. They never prove
/// that a frame is fresh; only its arrival on the monotonic clock can.
///
/// With t the arrival and s the stamp of a frame, t - s is a constant (the two clocks' offset) plus what the frame took
/// to arrive. Relative to an anchor, the first frame of an *epoch*,
///
///   x = (t - t0) - (s - s0),    least = min x so far,    late = x - least >= 0:   its extra delay, at least
///
/// A frame in order (s later than the last) with x not below -kAhead_us fits the epoch. It is stale if it is late by
/// more than max_age. Clocks drift, so the anchor follows by kDrift, and least rises by as much.
///
/// A stamp that goes backward or is in the future is refused. When kFramesToAgree of them in a row agree
/// with each other and with the monotonic clock, and for kSilence_us no frame has fitted the old epoch, the source's
/// clock was set: a new epoch begins, from rest. The silence keeps a delayed second path, or a recording that is played
/// beside the live source, from taking over in a gap. Frames that are merely late never end an epoch: that is a slow
/// pipeline, not a changed clock.
///
/// A frame whose t - s is that of one of the last frames continues the old numbering, whatever its stamp: then no clock
/// was set, and what was late stays late. So a single odd stamp does not start a new epoch.
///
/// A known age proves that the stamps are those of a clock of this host, and then it alone determines a frame's age. An
/// epoch of such a clock is never replaced by one of unknown ages; kConfirmations frames of such a clock within
/// a second end an epoch of unknown ages at once.
///
/// The anchor itself may have been late: then quicker frames appear to be in the future. kQuickFrames of them
/// within a second show this, and the next epoch is anchored on a quick one: later frames are checked more
/// strictly.
class FrameTimeline {
 public:
  /// A measurement is too old after max_age_us.
  explicit FrameTimeline(std::int64_t max_age_us) : max_age_us_(max_age_us) {}

  /// known_age_us: Frame::known_age_us. now: the frame's arrival, not before any earlier one.
  StampVerdict classify(std::int64_t utime, std::int64_t known_age_us, MonotonicTime now) noexcept;

  std::optional<std::int64_t> last_utime() const;  ///< of the last frame in order [us]
  std::int64_t epochs() const { return epochs_; }  ///< how often a new one began after the first

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.last_, self.numbering_, self.numbered_, self.offset_us_, self.least_us_, self.run_, self.agreeing_,
            self.epochs_, self.quick_, self.quick_since_, self.quick_epoch_at_, self.confirmed_, self.confirmations_,
            self.confirming_since_);
  }

  static constexpr int kFramesToAgree = 5;                     ///< number that begins a new epoch
  static constexpr double kAhead_us = 50'000.0;                ///< a stamp further ahead is in the future
  static constexpr double kAgree_us = 25'000.0;                ///< two clocks agree to this
  static constexpr std::size_t kNumbering = 4;                 ///< frames of the old numbering that are kept
  static constexpr int kConfirmations = 3;                     ///< known ages that end an unknown epoch
  static constexpr double kRunGap_us = 1'000'000.0;            ///< two frames of a run are not farther apart
  static constexpr double kSilence_us = 1'000'000.0;           ///< of the old epoch, before a new one begins
  static constexpr int kQuickFrames = 3;                       ///< number that shows that the anchor was late
  static constexpr double kQuickWithin_us = 1'000'000.0;       ///< within which these must come
  static constexpr double kQuickAgainAfter_us = 10'000'000.0;  ///< from one such epoch to the next
  /// A known age beyond this, in either direction, is that of an unsynchronised clock, or of a recording: it
  /// is considered only where an epoch begins.
  static constexpr double kSharedClock_us = 10'000'000.0;
  static constexpr double kDrift = 1e-3;  ///< of two clocks, of which one may be slewed

 private:
  struct Mark {  // no initialisers: clang would not accept its default constructor inside this class
    std::int64_t utime;
    MonotonicTime at;
  };
  bool agrees_with_run(std::int64_t utime, MonotonicTime now) const noexcept;
  bool continues_numbering(std::int64_t utime, MonotonicTime now) const noexcept;
  void remember_numbering(std::int64_t utime, MonotonicTime now) noexcept;
  bool may_begin(std::int64_t known_age_us) const noexcept { return !confirmed_ || known_age_us != 0; }
  bool is_proven(std::int64_t known_age_us, MonotonicTime now) noexcept;
  bool is_confirmed_quick(double offset_us, MonotonicTime now) noexcept;
  StampVerdict refuse(Reason reason, std::int64_t utime, MonotonicTime now) noexcept;
  StampVerdict begin_epoch(std::int64_t utime, std::int64_t known_age_us, MonotonicTime now) noexcept;

  std::int64_t max_age_us_;
  std::optional<Mark> last_;  ///< of this epoch
  std::array<Mark, kNumbering> numbering_{};
  std::uint64_t numbered_ = 0;  ///< frames of this epoch's numbering; the last kNumbering of them are in numbering_
  double offset_us_ = 0.0;      ///< x of the last
  double least_us_ = 0.0;
  std::optional<Mark> run_;  ///< the last of those that do not fit
  int agreeing_ = 0;
  std::int64_t epochs_ = 0;
  int quick_ = 0;  ///< frames quicker than the anchor allows, since quick_since_
  std::optional<MonotonicTime> quick_since_, quick_epoch_at_;
  bool confirmed_ = false;  ///< this epoch's stamps are those of a clock of this host
  int confirmations_ = 0;   ///< frames with a known age in an epoch of unknown ages, since confirming_since_
  std::optional<MonotonicTime> confirming_since_;
};

}  // namespace pilotfish
PILOTFISH_API_END
