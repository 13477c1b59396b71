#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "pilotfish/api.hpp"
#include "pilotfish/core/bounded_vector.hpp"
#include "pilotfish/core/planar_motion.hpp"
#include "pilotfish/core/range_scan.hpp"
#include "pilotfish/core/twist.hpp"

PILOTFISH_API_BEGIN
namespace pilotfish::control {

/// The motion from one pose to another, in the frame of the first.
Pose2 motion_between(const Pose2& before, const Pose2& after) noexcept;

/// Directions around the robot in which the nearest surface is kept.
inline constexpr std::size_t kSectors = 180;
inline constexpr double kSector_rad = 2.0 * kPi / static_cast<double>(kSectors);

/// A point of a surface, in the robot's base frame.
struct SurfacePoint {
  double x_m = 0.0;  ///< ahead
  double y_m = 0.0;  ///< to the left
};

/// A disc on the ground, in the robot's base frame.
struct Disc {
  double x_m = 0.0, y_m = 0.0, radius_m = 0.0;  ///< centre and radius [m]
};

/// What fresh ranges show around the robot.
struct ObstacleView {
  BoundedVector<SurfacePoint, kSectors> points;  ///< the nearest of each sector in which there is any
  std::bitset<kSectors> covered;                 ///< sectors into which some reading looked

  /// Whether some reading looked into every direction within half_rad of `direction_rad`.
  bool covers(double direction_rad, double half_rad) const noexcept;
};

/// How readings are taken.
struct RangeReadingModel {
  double cone_rad = 0.0;       ///< full opening of one reading: the surface may lie anywhere across it
  double max_range_m = 100.0;  ///< a reading at or above says that nothing is nearer than this
  double max_age_s = 0.0;      ///< an older one says nothing
};

/// The latest reading in each direction, moved along with the robot's own motion since. A value of no more than
/// kMaxRanges readings; never allocates.
class RangeField {
 public:
  /// The readings of a usable scan. `own`: the robot's twist around `present_utime`, the time of the last moved().
  void add(const RangeScan& scan, const Twist& own, std::int64_t present_utime) noexcept;
  /// The robot went from one pose to another, both in one frame, whichever.
  void moved(const Pose2& before, const Pose2& after) noexcept;
  void clear() noexcept;  ///< knows nothing any more

  /// Whether there is a scan that is not older than max_age_s at utime [us].
  bool fresh_at(std::int64_t utime, double max_age_s) const noexcept;
  std::optional<std::int64_t> utime() const { return utime_; }  ///< of the last scan [us]
  double heading_rad() const { return here_.heading_rad; }      ///< of the robot, in a frame of this field's own

  /// What is around a robot that is at `from`, in the base frame of the robot now: readings not older than
  /// model.max_age_s at utime [us]. Readings that `explained` accounts for, because it stands in their cone and no
  /// nearer surface does, leave no points.
  ObstacleView view(const RangeReadingModel& model, std::int64_t utime, const Pose2& from = {},
                    const Disc* explained = nullptr) const noexcept;

  template <class Self, class Archive>
  static void remember(Self& self, Archive& archive) {  ///< see core/checkpoint.hpp
    archive(self.readings_, self.here_, self.utime_, self.step_rad_);
  }

 private:
  struct Reading {
    double range_m = -1.0, direction_rad = 0.0;  ///< below 0: none
    Pose2 taken_at;
    std::int64_t utime = 0;
  };
  BoundedVector<Reading, kMaxRanges> readings_;
  Pose2 here_;
  std::optional<std::int64_t> utime_;
  double step_rad_ = 0.0;  ///< between two readings of the last scan
};

}  // namespace pilotfish::control
PILOTFISH_API_END
